"""Breath-hold misregistration: one in-plane shift a short-axis slice, learned with the field.

Only what the evidence holds may move. Long-axis slices stay, and hold the stack along their own
in-plane direction. Along a direction that none of them holds, breath-holds are told from anatomy
by smoothness alone: shifts that vary smoothly from slice to slice are taken out.
"""

import numpy as np
import torch
from torch import Tensor, nn

from schemas.vocabulary import View
from worker.arrays import Points
from worker.reconstruction.unit_stack import UnitSlice, UnitStack

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

    def __init__(self, stack: UnitStack, prior: float, limit: float) -> None:
        """The stack holds the outlines that are fitted to.

        prior: standard deviation of a shift; limit: the largest; both in unit lengths.
        """
        super().__init__()
        # A slice without outlines is the same wherever it lies in its plane.
        free = [s.view is View.SAX and bool(s.outlines) for s in stack.slices]
        self._free = torch.tensor(free, dtype=torch.float32)[:, None]
        self._axes = torch.tensor(np.stack([s.axes for s in stack.slices]), dtype=torch.float32)
        self._unobservable = torch.as_tensor(_unobservable(stack, free), dtype=torch.float32)
        self._precision = torch.tensor(_evidence_handicap(stack)) / prior**2
        self._limit = limit
        self.in_plane = nn.Parameter(torch.zeros(len(free), 2))

    def displacements(self) -> Tensor:
        """(slices + 1, 3) unit lengths; the last row is zero, for samples of no slice."""
        moved = torch.einsum("ka,kad->kd", self.in_plane * self._free, self._axes)
        return torch.cat([moved, torch.zeros(1, 3)])

    def aligned(self, points_unit: Tensor, slice_index: Tensor) -> Tensor:
        """Points (n, 3) moved back by the shift of the slice each was drawn on."""
        return points_unit - self.displacements()[slice_index]

    def negative_log_prior(self) -> Tensor:
        """Mean over free slices of half the squared shift in standard deviations.

        A slice with short outlines holds its shift weakly, yet is sampled as densely as any: its
        prior is tighter by as much as its outlines are shorter than the others'.
        """
        squares = (self.in_plane * self._free).square().sum(dim=1)
        return 0.5 * (squares * self._precision).sum() / self._free.sum().clamp_min(1.0)

    @torch.no_grad()
    def restrain(self) -> None:
        """Take out what the slices cannot know, and keep every shift within the limit."""
        flat = self.in_plane.mul_(self._free).view(-1)
        flat -= self._unobservable @ (self._unobservable.t() @ flat)
        length = self.in_plane.norm(dim=1, keepdim=True)
        self.in_plane.mul_((self._limit / length.clamp_min(1e-12)).clamp_max(1.0))

    def found(self) -> Points:
        """(slices, 3) displacement of every slice, unit lengths."""
        with torch.no_grad():
            return self.displacements()[:-1].numpy().astype(np.float64)


def _evidence_handicap(stack: UnitStack) -> list[float]:
    """By what factor each slice's outlines are shorter than the median slice's, one at least."""
    lengths = np.array([_outline_length(s) for s in stack.slices])
    typical = np.median(lengths[lengths > 0.0])
    return [float(max(1.0, typical / length)) if length > 0.0 else 1.0 for length in lengths]


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
