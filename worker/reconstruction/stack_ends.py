"""How far the hull must reach past the first and last short-axis slice."""

import numpy as np

from schemas.vocabulary import Structure, View
from worker.arrays import Points, Vector
from worker.reconstruction.unit_stack import UnitSlice, UnitStack

_SHARE_OF_END = 0.5
"""Of what long-axis slices show beyond a stack's end: so far an end slice's outline is carried. A
hull of few planes would cut the rounded end flat between them; a spheroid is 0.87 as wide there."""


def past_the_ends(stack: UnitStack, inflation: float) -> Points:
    """Outlines of a short-axis stack's end slices, moved outward; (n, 3) unit.

    Where long-axis slices show a structure going on beyond the stack, its end outlines are moved
    half as far. Without long-axis slices, inflated by `inflation` about the centroid of all
    outlines they lie one slice gap beyond the stack: for all that is known, what the last slice
    shows ends halfway to where the next would have been. Empty for fewer than two slices.
    """
    showing = [s for s in stack.slices if s.view is View.SAX and s.outlines]
    if len(showing) < 2:
        return np.empty((0, 3))
    normal = showing[0].normal
    showing.sort(key=lambda s: float(s.origin @ normal))
    if any(s.view.is_long_axis and s.outlines for s in stack.slices):
        return _toward_shown_ends(stack, showing, normal)
    return _past_by_a_gap(stack, showing, normal, inflation)


def _toward_shown_ends(stack: UnitStack, showing: list[UnitSlice], normal: Vector) -> Points:
    moved = [np.empty((0, 3))]
    for structure in sorted({structure for s in showing for structure in s.outlines}):
        heights = [
            slice_.lift(outline.points) @ normal
            for slice_ in stack.slices
            if slice_.view.is_long_axis
            for outline in slice_.outlines.get(structure, ())
        ]
        if not heights:
            continue
        own = [s for s in showing if structure in s.outlines]
        low, high = float(np.concatenate(heights).min()), float(np.concatenate(heights).max())
        for end, beyond in (
            (own[0], min(low - _height(own[0], normal), 0.0)),
            (own[-1], max(high - _height(own[-1], normal), 0.0)),
        ):
            moved.append(_lifted(end, structure) + _SHARE_OF_END * beyond * normal)
    return np.concatenate(moved)


def _past_by_a_gap(
    stack: UnitStack, showing: list[UnitSlice], normal: Vector, inflation: float
) -> Points:
    middle = float(stack.points_unit.mean(axis=0) @ normal)
    heights = np.array([_height(s, normal) for s in showing]) - middle
    gap = float(np.median(np.diff(heights)))
    moved = []
    for slice_, height in ((showing[0], heights[0]), (showing[-1], heights[-1])):
        beyond = abs(height) + gap
        step = np.sign(height) * max(beyond / inflation - abs(height), 0.0)
        moved += [_lifted(slice_, structure) + step * normal for structure in slice_.outlines]
    return np.concatenate(moved)


def _height(slice_: UnitSlice, normal: Vector) -> float:
    return float(slice_.origin @ normal)


def _lifted(slice_: UnitSlice, structure: Structure) -> Points:
    return np.concatenate([slice_.lift(o.points) for o in slice_.outlines[structure]])
