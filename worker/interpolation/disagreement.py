"""How far slices that cross disagree about where a surface is."""

import numpy as np
from scipy.spatial import cKDTree

from intake.planes import Plane
from schemas.vocabulary import Structure, View
from worker.arrays import Points
from worker.interpolation.outline_points import evenly_along
from worker.reconstruction.slice_stack import Outline, SliceStack

_STEP_MM = 0.25


def disagreement_mm(stack: SliceStack, structure: Structure) -> float:
    """Root mean square distance, mm, at which other views' outlines miss the short-axis ones.

    Where an outline of another view passes through the plane of a short-axis slice that shows
    `structure` too, both should meet; the distance is in that plane, to its nearest outline.
    0 where no outlines cross, as without long-axis slices: then nothing can disagree.
    """
    others = [
        outline
        for s in stack.slices
        if s.view is not View.SAX
        for outline in s.outlines.get(structure, ())
    ]
    misses = [np.empty(0)]
    for slice_ in stack.slices:
        if slice_.view is not View.SAX or not slice_.outlines.get(structure):
            continue
        plane = Plane.through(slice_.origin_mm, slice_.normal)
        drawn = cKDTree(
            np.concatenate(
                [
                    evenly_along(plane.to_plane(o.points_mm), _STEP_MM, closed=o.closed)
                    for o in slice_.outlines[structure]
                ]
            )
        )
        misses += [
            drawn.query(plane.to_plane(through))[0]
            for outline in others
            if len(through := _passing(outline, plane))
        ]
    squared = np.concatenate(misses) ** 2
    return float(np.sqrt(squared.mean())) if len(squared) else 0.0


def _passing(outline: Outline, plane: Plane) -> Points:
    """Where an outline passes through a plane, (k, 3) mm."""
    starts, ends = outline.points_mm, np.roll(outline.points_mm, -1, axis=0)
    if not outline.closed:
        starts, ends = starts[:-1], ends[:-1]
    before, after = plane.signed_distance(starts), plane.signed_distance(ends)
    passes = before * after < 0.0
    t = before[passes] / (before[passes] - after[passes])
    return starts[passes] + t[:, None] * (ends - starts)[passes]
