"""How far a surface is from what was observed of it: exact distances to its contours."""

from collections.abc import Sequence
from dataclasses import dataclass

import igl
import numpy as np

from schemas.problem import InternalError, ProblemType
from schemas.vocabulary import View
from worker.arrays import Points, Scalars, SomePoints
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
    corners = np.ascontiguousarray(np.concatenate([o.points_mm for o in outlines]), np.float64)
    segments, first = [], 0
    for outline in outlines:
        count = len(outline.points_mm)
        starts = np.arange(count if outline.closed else count - 1)
        segments.append(first + np.stack([starts, (starts + 1) % count], axis=1))
        first += count
    ends = np.ascontiguousarray(np.concatenate(segments))
    boxes = igl.AABB()
    boxes.init(corners, ends)
    points = np.ascontiguousarray(points_mm, dtype=np.float64)
    squared, _, _ = boxes.squared_distance(corners, ends, points)
    distances: Scalars = np.sqrt(np.maximum(squared, 0.0))
    return distances


def area_beyond_percent(mesh: SurfaceMesh, support_mm: Scalars, reach_mm: float) -> float:
    """Share of the surface's area further than `reach_mm` from its contours.

    support_mm: (n,) of the vertices; a triangle has the mean of its corners.
    """
    areas = triangle_areas_mm2(mesh)
    beyond = support_mm[mesh.faces].mean(axis=1) > reach_mm
    return float(100.0 * areas[beyond].sum() / areas.sum())
