"""Breath-hold misregistration: one in-plane shift a short-axis slice, learned with the field.

Where asked for, each slice also carries a rotation about its own normal.

Only what the evidence holds may move. Long-axis slices stay, and hold the stack along their own
in-plane direction. Along a direction that none of them holds, breath-holds are told from anatomy
by smoothness alone: shifts that vary smoothly from slice to slice are taken out.
"""

import math

import numpy as np
import torch
from torch import Tensor, nn
from torch.nn import functional

from schemas.vocabulary import View
from worker.reconstruction.motion import SliceMotion
from worker.reconstruction.shift_evidence import ShiftEvidence
from worker.reconstruction.unit_stack import UnitSlice, UnitStack

_PRIOR_WEIGHT = 2e-4
"""Weight of the shift prior against the mean BCE: it breaks ties, the contours decide."""

_FURTHEST_TURN = math.radians(20.0)
"""No slice turns further."""

_HELD = 0.1
"""Least squared sine between a direction and the long-axis planes' normals to count as held."""

_ANATOMY_DEGREE = 3
"""Profiles along the stack up to this degree are anatomy where no long-axis slice says otherwise.

A common shift (0) and shear (1) change nothing observed; the ventricles' own bend and twist (2, 3)
look to the field like shifts, and it would straighten them.
"""


class SliceShifts(nn.Module):
    """Displacements of slices in their own planes, unit lengths; zero for slices that stay.

    Free to move are short-axis slices with outlines.
    """

    def __init__(
        self, stack: UnitStack, evidence: ShiftEvidence, limit: float, *, turning: bool = False
    ) -> None:
        """The stack holds the outlines that are fitted to.

        evidence: where shifts start, how firmly each is held there, and whether they move at all.
        limit: the largest shift, unit lengths. turning: whether slices rotate, too.
        """
        super().__init__()
        # A slice without outlines is the same wherever it lies in its plane.
        free = [s.view is View.SAX and bool(s.outlines) for s in stack.slices]
        self._free = _single(free)[:, None]
        self._axes = _single([s.axes for s in stack.slices])
        self._normals = _single([s.normal for s in stack.slices])
        self._pivots = _single([s.lift(s.pivot[None])[0] for s in stack.slices])
        self._unobservable = _single(_unobservable(stack, [] if evidence.final else free))
        self._precision = _single(evidence.precision * _handicap(stack)[:, None, None])
        self._limit = limit
        self._settled = torch.as_tensor(evidence.settled)[:, None]
        self.in_plane = nn.Parameter(_single(evidence.motion[:, :2]))
        # Evidence of slices that do not turn holds them at nothing, but for rounding.
        turns = _single(evidence.motion[:, 2] if turning else np.zeros(len(free)))
        self.turns = nn.Parameter(turns, requires_grad=turning)
        self._project()
        self._expected = self._motion().detach().clone()
        unsettled = bool((self._free.bool() & ~self._settled).any())
        self.moving = evidence.displaced and unsettled and not evidence.final

    def displacements(self) -> Tensor:
        """(slices, 3) unit lengths."""
        return torch.einsum("ka,kad->kd", self.in_plane * self._free, self._axes)

    def aligned(self, points_unit: Tensor, slice_index: Tensor) -> Tensor:
        """Points (n, 3) moved back by the shift, and turn, of the slice each was drawn on."""
        # A last row for samples of no slice, index -1.
        shifts = functional.pad(self.displacements(), (0, 0, 0, 1))[slice_index]
        if not self.turns.requires_grad:
            return points_unit - shifts
        turns = functional.pad(self.turns * self._free[:, 0], (0, 1))[slice_index, None]
        normals, pivots = self._normals[slice_index], self._pivots[slice_index]
        across = torch.linalg.cross(normals, points_unit - pivots)
        outward = torch.linalg.cross(normals, across)
        # Rodrigues: a turn by -t of what lies about the pivot.
        turned = points_unit - torch.sin(turns) * across + (1.0 - torch.cos(turns)) * outward
        return turned - shifts

    def penalty(self) -> Tensor:
        """What departing from the evidence costs, beside a mean BCE.

        Mean over free slices of half the squared departure in standard deviations, weighted. In a
        stack without long-axis slices, a slice with short outlines holds its shift weakly, yet is
        sampled as densely as any: it is held the firmer, the shorter its outlines are.
        """
        departure = (self._motion() - self._expected) * self._free
        squares = torch.einsum("ka,kab,kb->", departure, self._precision, departure)
        return _PRIOR_WEIGHT * 0.5 * squares / self._free.sum().clamp_min(1.0)

    def _motion(self) -> Tensor:
        return torch.cat([self.in_plane, self.turns[:, None]], dim=1)

    @torch.no_grad()
    def restrain(self) -> None:
        """Take out what the slices cannot know, keep every motion within its limit, and put back
        what the evidence has settled.
        """
        self._project()
        self.in_plane.copy_(torch.where(self._settled, self._expected[:, :2], self.in_plane))
        self.turns.copy_(torch.where(self._settled[:, 0], self._expected[:, 2], self.turns))

    @torch.no_grad()
    def _project(self) -> None:
        flat = self.in_plane.mul_(self._free).view(-1)
        flat -= self._unobservable @ (self._unobservable.t() @ flat)
        length = self.in_plane.norm(dim=1, keepdim=True)
        self.in_plane.mul_((self._limit / length.clamp_min(1e-12)).clamp_max(1.0))
        self.turns.mul_(self._free[:, 0]).clamp_(-_FURTHEST_TURN, _FURTHEST_TURN)

    @torch.no_grad()
    def found(self) -> SliceMotion:
        """What the slices were found moved by."""
        return SliceMotion(
            self.displacements().numpy().astype(np.float64),
            self.turns.numpy().astype(np.float64),
            self._pivots.numpy().astype(np.float64),
        )


def _single(values: object) -> Tensor:
    return torch.as_tensor(np.asarray(values), dtype=torch.float32)


def _handicap(stack: UnitStack) -> np.ndarray:
    """By what factor each slice's outlines are shorter than the median slice's, one at least."""
    lengths = np.array([_outline_length(s) for s in stack.slices])
    if any(s.view.is_long_axis and s.outlines for s in stack.slices) or not lengths.any():
        return np.ones(len(lengths))
    typical = np.median(lengths[lengths > 0.0])
    return np.maximum(1.0, typical / np.where(lengths > 0.0, lengths, typical))


def _outline_length(slice_: UnitSlice) -> float:
    edges = [o.edges for outlines in slice_.outlines.values() for o in outlines]
    return float(sum(np.linalg.norm(ends - starts, axis=1).sum() for starts, ends in edges))


def _unobservable(stack: UnitStack, free: list[bool]) -> np.ndarray:
    """Orthonormal columns over (slices * 2): smooth profiles along unheld directions."""
    count = len(stack.slices)
    movers = np.flatnonzero(free)
    if len(movers) == 0:
        return np.zeros((2 * count, 0))
    normal = stack.slices[movers[0]].normal
    heights = np.array([s.origin @ normal for s in stack.slices])[movers]
    columns = []
    for direction in _unheld_directions(stack, normal):
        for profile in np.vander(heights, _ANATOMY_DEGREE + 1).T:
            column = np.zeros((count, 2))
            for slice_index, amount in zip(movers, profile, strict=True):
                column[slice_index] = amount * (stack.slices[slice_index].axes @ direction)
            columns.append(column.ravel())
    if not columns:
        return np.zeros((2 * count, 0))
    u, sizes, _ = np.linalg.svd(np.stack(columns, axis=1), full_matrices=False)
    return u[:, sizes > 1e-9]


def _unheld_directions(stack: UnitStack, normal: np.ndarray) -> list[np.ndarray]:
    """Directions across `normal` along which no crossing slice fixes the stack."""
    helper = np.eye(3)[int(np.argmin(np.abs(normal)))]
    first = np.cross(normal, helper)
    first /= np.linalg.norm(first)
    basis = np.stack([first, np.cross(normal, first)])
    held = np.zeros((2, 2))
    for slice_ in stack.slices:
        if slice_.view is View.SAX or not slice_.outlines:
            continue
        crossing = basis @ np.cross(slice_.normal, normal)
        held += np.outer(crossing, crossing)
    strength, directions = np.linalg.eigh(held)
    return [directions[:, i] @ basis for i in range(2) if strength[i] < _HELD]
