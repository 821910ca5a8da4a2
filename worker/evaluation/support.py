"""How far a surface is from what was observed of it: exact distances to its contours."""

from collections.abc import Sequence
from dataclasses import dataclass

import numpy as np

from schemas.problem import InternalError, ProblemType
from schemas.vocabulary import View
from worker.arrays import Points, Scalars, SomePoints
from worker.evaluation.segment_distance import distance_to_segments_mm, ring_segments
from worker.evaluation.size import triangle_areas_mm2
from worker.surface_mesh import SurfaceMesh


@dataclass(frozen=True, eq=False)
class AlignedOutline:
    """One observed outline where alignment moved it to.

    points_mm: (n, 3), patient axes. closed: the last point joins the first. An open outline ends
        at its ends: the chord that closes it for the fit was not observed.
    """

    slice_id: str
    view: View
    points_mm: SomePoints
    closed: bool


def distance_to_outlines_mm(points_mm: Points, outlines: Sequence[AlignedOutline]) -> Scalars:
    """Exact distance from each of (n, 3) points to the nearest outline, its segments and not only
    its points, (n,) mm. Raises InternalError when there are no outlines.
    """
    if not outlines:
        raise InternalError(ProblemType.INTERNAL, "No outlines to measure a distance to.")
    segments, first = [], 0
    for outline in outlines:
        ring = first + ring_segments(len(outline.points_mm))
        segments.append(ring if outline.closed else ring[:-1])
        first += len(ring)
    ends_mm = np.concatenate([one.points_mm for one in outlines])
    return distance_to_segments_mm(points_mm, ends_mm, np.concatenate(segments))


def area_beyond_percent(mesh: SurfaceMesh, support_mm: Scalars, reach_mm: float) -> float:
    """Share of the surface's area further than `reach_mm` from its contours.

    support_mm: (n,) of the vertices; a triangle has the mean of its corners.
    """
    areas = triangle_areas_mm2(mesh)
    beyond = support_mm[mesh.faces].mean(axis=1) > reach_mm
    return float(100.0 * areas[beyond].sum() / areas.sum())
