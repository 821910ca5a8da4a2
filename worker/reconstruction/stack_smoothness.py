"""What a short-axis stack says of its own slices' shifts, where no long-axis slice crosses it.

Ventricles bend smoothly from apex to base; breath-holds jump from slice to slice. So the centroids
of a structure follow a polynomial of low degree, but for the slices' shifts and some anatomy. How
far they stray from it tells how far slices are displaced at all: little, and nothing is moved.
A shift that is itself smooth along the stack looks like anatomy and stays.
"""

from dataclasses import dataclass

import numpy as np
from jaxtyping import Float, Int

from schemas.vocabulary import Structure, View
from worker.arrays import PlanePoints, Scalars
from worker.reconstruction.shift_evidence import ShiftEvidence, no_evidence, prior_precision
from worker.reconstruction.unit_stack import UnitSlice, UnitStack

_ANATOMY_DEGREE = 4
"""Polynomials along the stack, up to this degree, are taken for anatomy."""

_LEAST_LEFT = 2
"""Slices beyond a polynomial's coefficients that it takes to speak of strays."""

_ANATOMY_MM = {
    Structure.LV_ENDO: 0.8,
    Structure.LV_EPI: 0.9,
    Structure.EPI: 2.0,
    Structure.RV_ENDO: 3.5,
    Structure.RV_EPI: 3.5,
}
"""How far centroids of aligned hearts stray from such a polynomial, mm, along each axis."""


@dataclass(frozen=True, eq=False)
class _Strays:
    """Where one structure's centroids leave their polynomial, in the plane of the stack.

    slices: indices. left: what the polynomial leaves of a displacement of each of them.
    anatomy: standard deviation expected of an aligned heart.
    """

    slices: Int[np.ndarray, " k"]
    strays: Float[np.ndarray, "k 2"]
    left: Float[np.ndarray, "k k"]
    anatomy: float

    @property
    def variance(self) -> float:
        """Of the strays along each axis, per slice left over."""
        return float((self.strays**2).sum() / (2.0 * np.trace(self.left)))


def smoothness_evidence(
    stack: UnitStack, prior: float, noise: float, unit_mm: float, *, turning: bool = False
) -> ShiftEvidence:
    """Shifts of a stack's short-axis slices from their centroids, unit lengths.

    prior, noise: a shift's standard deviation along each direction, at most and at least. A stack
    displaced by less than the noise is held as it is. turning: whether slices turn, too, of which
    centroids say nothing.
    """
    movers = [i for i, s in enumerate(stack.slices) if s.view is View.SAX and s.outlines]
    found = [
        strays
        for structure, anatomy_mm in _ANATOMY_MM.items()
        if (strays := _strays(stack, movers, structure, anatomy_mm / unit_mm)) is not None
    ]
    # The steadiest structure tells how far this stack's slices are displaced.
    steadiest = min(found, key=lambda one: one.anatomy, default=None)
    excess = steadiest.variance - steadiest.anatomy**2 if steadiest else 0.0
    if excess < noise**2:
        return no_evidence(len(stack.slices), prior)
    expected = min(excess**0.5, prior)
    count = len(stack.slices)
    precision = np.eye(count) / expected**2
    pull = np.zeros((count, 2))
    for one in found:
        precision[np.ix_(one.slices, one.slices)] += one.left / one.anatomy**2
        pull[one.slices] += one.left @ one.strays / one.anatomy**2
    in_space = np.linalg.solve(precision, pull) @ stack.slices[movers[0]].axes
    shifts = [s.axes @ shift for s, shift in zip(stack.slices, in_space, strict=True)]
    return ShiftEvidence(
        motion=np.column_stack([np.array(shifts), np.zeros(count)]),
        precision=np.tile(prior_precision(expected, turning), (count, 1, 1)),
        crossings=np.zeros(count, dtype=np.int64),
        settled=np.zeros(count, dtype=bool),
        displaced=True,
    )


def _strays(
    stack: UnitStack, movers: list[int], structure: Structure, anatomy: float
) -> _Strays | None:
    """None where too few slices show the structure to tell a stray from a bend."""
    showing = [i for i in movers if structure in stack.slices[i].outlines]
    degree = min(_ANATOMY_DEGREE, len(showing) - 1 - _LEAST_LEFT)
    if degree < 1:
        return None
    first = stack.slices[showing[0]]
    heights: Scalars = np.array([stack.slices[i].origin @ first.normal for i in showing])
    smooth = np.linalg.qr(np.vander(heights, degree + 1))[0]
    left = np.eye(len(showing)) - smooth @ smooth.T
    axes = stack.slices[movers[0]].axes
    centroids = np.array([_centroid(stack.slices[i], structure) @ axes.T for i in showing])
    return _Strays(np.array(showing), left @ centroids, left, anatomy)


def _centroid(slice_: UnitSlice, structure: Structure) -> Float[np.ndarray, "3"]:
    """Of the area that the structure's largest outline encloses in the slice."""
    _, centre = max(
        (_area_and_centre(o.points) for o in slice_.outlines[structure]), key=lambda pair: pair[0]
    )
    return slice_.lift(centre[None])[0]


def _area_and_centre(ring: PlanePoints) -> tuple[float, Float[np.ndarray, "2"]]:
    middle = ring.mean(axis=0)
    start = ring - middle
    end = np.roll(start, -1, axis=0)
    twice = start[:, 0] * end[:, 1] - end[:, 0] * start[:, 1]
    total = twice.sum()
    if abs(total) < 1e-12:
        return 0.0, middle
    return 0.5 * abs(float(total)), middle + ((start + end) * twice[:, None]).sum(0) / (3.0 * total)
