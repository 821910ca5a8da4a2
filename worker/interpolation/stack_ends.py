"""Where a structure ends that its slices leave open: points that are outside, beyond its ends."""

import numpy as np

from intake.even_odd import inside
from intake.planes import Plane
from schemas.vocabulary import Structure, View
from worker.arrays import Points, Scalars
from worker.interpolation.outline_points import evenly_along
from worker.reconstruction.slice_stack import Outline, SliceStack, StackSlice

_USUAL_GAP_MM = 8.0
"""Between short-axis slices, where a stack has fewer than two."""
_PITCH_MM = 4.0


def beyond_ends(stack: SliceStack, structure: Structure) -> tuple[Points, Scalars]:
    """Points (n, 3) mm that are outside, and (n,) minus their distance to the outlines, mm.

    Outlines on short-axis slices alone end half a slice gap beyond the first and last, or halfway
    to a nearer slice where the structure is absent: the points lie twice as far, over the inside of
    the end slice. An open outline ends at its chord: the points lie half a gap beyond it, in its
    plane. Closed long-axis outlines show the ends themselves: then there are no points.
    """
    gap = _gap_mm(stack)
    found = [*_past_the_stack(stack, structure, gap), *_past_the_chords(stack, structure, gap / 2)]
    points = [p for p, _ in found]
    values = [np.full(len(p), -away) for p, away in found]
    if not points:
        return np.empty((0, 3)), np.empty(0)
    return np.concatenate(points), np.concatenate(values)


def _gap_mm(stack: SliceStack) -> float:
    axial = [s for s in stack.slices if s.view is View.SAX]
    if len(axial) < 2:
        return _USUAL_GAP_MM
    heights = np.sort([s.origin_mm @ axial[0].normal for s in axial])
    return float(np.median(np.diff(heights)))


def _past_the_stack(
    stack: SliceStack, structure: Structure, gap_mm: float
) -> list[tuple[Points, float]]:
    showing = [s for s in stack.slices if s.outlines.get(structure)]
    if len(showing) < 2 or any(s.view is not View.SAX for s in showing):
        return []
    normal = showing[0].normal
    showing.sort(key=lambda s: float(s.origin_mm @ normal))
    empty = np.array([s.origin_mm @ normal for s in stack.slices if _is_empty(s, structure)])
    found = []
    for slice_, sign in ((showing[0], -1.0), (showing[-1], 1.0)):
        further = sign * (empty - slice_.origin_mm @ normal)
        reach = float(min([gap_mm, *further[further > 0.0]]))
        found.append((_over(slice_, structure) + sign * reach * normal, reach))
    return found


def _is_empty(slice_: StackSlice, structure: Structure) -> bool:
    return slice_.view is View.SAX and structure in slice_.absent


def _over(slice_: StackSlice, structure: Structure) -> Points:
    """Points over the inside of a slice, its outlines among them."""
    plane = Plane.through(slice_.origin_mm, slice_.normal)
    rings = [plane.to_plane(o.points_mm) for o in slice_.outlines[structure]]
    low = np.min([r.min(axis=0) for r in rings], axis=0)
    high = np.max([r.max(axis=0) for r in rings], axis=0)
    axes = [np.arange(a, b, _PITCH_MM) for a, b in zip(low, high, strict=True)]
    grid = np.stack(np.meshgrid(*axes), axis=-1).reshape(-1, 2)
    rims = [evenly_along(r, _PITCH_MM, closed=True) for r in rings]
    return plane.to_space(np.concatenate([grid[inside(grid, rings)], *rims]))


def _past_the_chords(
    stack: SliceStack, structure: Structure, reach_mm: float
) -> list[tuple[Points, float]]:
    return [
        (_past_a_chord(Plane.through(s.origin_mm, s.normal), o, reach_mm), reach_mm)
        for s in stack.slices
        for o in s.outlines.get(structure, ())
        if not o.closed
    ]


def _past_a_chord(plane: Plane, outline: Outline, reach_mm: float) -> Points:
    ring = plane.to_plane(outline.points_mm)
    start, end = ring[-1], ring[0]
    along = end - start
    across = np.array([along[1], -along[0]]) / max(float(np.linalg.norm(along)), 1e-12)
    if (ring.mean(axis=0) - start) @ across > 0.0:
        across = -across
    chord = evenly_along(np.stack([start, end]), _PITCH_MM, closed=False)[1:-1]
    return plane.to_space(chord + reach_mm * across)
