"""Where a surface goes on beyond its short-axis slices: at the apex and at the base."""

from collections.abc import Mapping, Sequence
from dataclasses import dataclass

import numpy as np

from schemas.vocabulary import Structure, View
from worker.arrays import Scalars, SomePoints, Vector
from worker.evaluation.support import AlignedOutline
from worker.surface_mesh import SurfaceMesh

_REACHES = 0.5
"""Part of an end's height up to which a long-axis contour must go to show it."""


@dataclass(frozen=True)
class SurfaceEnd:
    """What lies beyond the last short-axis slice that shows the surface.

    height_mm: how far the surface goes on; 0 when it ends before.
    support_max_mm: largest distance of a vertex there to the nearest contour; 0 without such.
    on_long_axis: a contour of another view follows the surface for half of that height or more.
    """

    height_mm: float
    support_max_mm: float
    on_long_axis: bool


def apex_to_base(outlines: Mapping[Structure, Sequence[AlignedOutline]]) -> Vector | None:
    """Unit normal of a frame's short-axis slices, pointing to the base, by all of its outlines.

    The ends of open long-axis outlines are at the base; without them it is where short-axis
    outlines are wider. None when there are no short-axis outlines, or none outlines an area.
    """
    every = [one for group in outlines.values() for one in group]
    across = [one for one in every if one.view is View.SAX]
    normals = [_normal(one.points_mm) for one in across]
    if not normals or not any(np.any(normal) for normal in normals):
        return None
    first = next(normal for normal in normals if np.any(normal))
    axis = np.sum([n if n @ first >= 0 else -n for n in normals], axis=0)
    axis /= np.linalg.norm(axis)
    middle = np.concatenate([one.points_mm for one in every]).mean(axis=0)
    arcs = [one.points_mm for one in every if not one.closed and one.view is not View.SAX]
    if arcs:
        ends = np.array([end for arc in arcs for end in (arc[0], arc[-1])])
        upward = float((ends.mean(axis=0) - middle) @ axis)
    else:
        heights = np.array([float((one.points_mm.mean(axis=0) - middle) @ axis) for one in across])
        widths = np.array([_width(one.points_mm) for one in across])
        upward = float(heights @ (widths - widths.mean()))
    return axis if upward >= 0.0 else -axis


def slice_gap_mm(toward_base: Vector, outlines: Sequence[AlignedOutline]) -> float | None:
    """Median distance between neighbouring short-axis slices that show a surface, if two do."""
    heights = np.sort([*_slice_heights(toward_base, outlines).values()])
    return float(np.median(np.diff(heights))) if len(heights) >= 2 else None


def surface_ends(
    mesh: SurfaceMesh,
    support_mm: Scalars,
    toward_base: Vector,
    outlines: Sequence[AlignedOutline],
) -> tuple[SurfaceEnd, SurfaceEnd] | None:
    """Apex and base of a surface, None when no short-axis slice shows it.

    support_mm: (n,) distance of each vertex to the nearest of `outlines`, those of this surface.
    """
    heights = [*_slice_heights(toward_base, outlines).values()]
    if not heights:
        return None
    of_vertices = mesh.vertices_mm @ toward_base
    others = [one.points_mm for one in outlines if one.view is not View.SAX]
    of_others = np.concatenate(others) @ toward_base if others else np.empty(0)
    apex = _end(min(heights) - of_vertices, support_mm, min(heights) - of_others)
    base = _end(of_vertices - max(heights), support_mm, of_others - max(heights))
    return apex, base


def _end(beyond_mm: np.ndarray, support_mm: np.ndarray, contours_mm: np.ndarray) -> SurfaceEnd:
    """From how far vertices and contour points are beyond the last slice."""
    height = max(float(beyond_mm.max()), 0.0)
    furthest = float(support_mm[beyond_mm > 0.0].max(initial=0.0))
    reached = bool(np.any(contours_mm >= _REACHES * height))
    return SurfaceEnd(height, furthest, reached)


def _slice_heights(toward_base: Vector, outlines: Sequence[AlignedOutline]) -> dict[str, float]:
    return {
        one.slice_id: float(one.points_mm.mean(axis=0) @ toward_base)
        for one in outlines
        if one.view is View.SAX
    }


def _normal(points_mm: SomePoints) -> Vector:
    """Unit normal of the plane of an outline, as its area points; zero for one without area."""
    around = points_mm - points_mm.mean(axis=0)
    area = np.cross(around, np.roll(around, -1, axis=0)).sum(axis=0)
    length = float(np.linalg.norm(area))
    return area / length if length > 0.0 else np.zeros(3)


def _width(points_mm: SomePoints) -> float:
    return float(np.linalg.norm(points_mm - points_mm.mean(axis=0), axis=1).mean())
