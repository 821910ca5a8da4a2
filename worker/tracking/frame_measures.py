"""A tracked mesh held against the frame's own surface."""

import numpy as np

from worker.arrays import Points
from worker.evaluation.distance import directed, distances_both_ways
from worker.evaluation.quality import triangle_quality
from worker.evaluation.size import triangle_areas_mm2
from worker.evaluation.triangle_crossings import self_intersections
from worker.surface_mesh import SurfaceMesh
from worker.tracking.faults import against, folded, turned_over
from worker.tracking.frame_surface import FrameSurface
from worker.tracking.patch import Patch
from worker.tracking.tracked_surface import TrackedFrame

_SAMPLES = 10_000


def measured(
    label: str, mesh: SurfaceMesh, surface: FrameSurface, rest: SurfaceMesh, before_mm: Points
) -> TrackedFrame:
    """Distances, faults and quality. rest: the mesh at the frame where it was made. before_mm: its
    vertices at the frame before this one.
    """
    to_surface, from_surface = distances_both_ways(mesh, surface.mesh, _SAMPLES)
    quality = triangle_quality(mesh)
    ratio = triangle_areas_mm2(mesh) / triangle_areas_mm2(rest)
    step_mm = np.linalg.norm(mesh.vertices_mm - before_mm, axis=1)
    return TrackedFrame(
        label=label,
        to_surface=directed(to_surface.distances_mm),
        from_surface=directed(from_surface.distances_mm),
        turned_over=int(turned_over(mesh).sum()),
        against_surface=int(against(mesh, surface).sum()),
        folded=int(folded(mesh, Patch.whole(mesh).pairs).sum()),
        self_intersections=len(self_intersections(mesh)),
        least_angle_deg=quality.min_angle_deg,
        below_20_deg_percent=quality.below_20_deg_percent,
        area_ratio_min=float(ratio.min()),
        area_ratio_max=float(ratio.max()),
        step_mean_mm=float(step_mm.mean()),
        step_max_mm=float(step_mm.max()),
    )
