"""How much the surface about each vertex has grown or shrunk."""

import numpy as np
from jaxtyping import Float

from worker.evaluation.size import triangle_areas_mm2
from worker.surface_mesh import SurfaceMesh
from worker.tracking.tracked_surface import TrackedSurface


def area_strain(tracked: TrackedSurface) -> Float[np.ndarray, "frames n"]:
    """Area of the triangles about each vertex over that at the frame of the mesh, less one.

    Its mean over a surface is observed. How it is spread depends on the tangential motion, which
    the regulariser alone decides (`NOT_OBSERVED`).
    """
    frames = range(len(tracked.vertices_mm))
    areas = np.stack([_around_vertices_mm2(tracked.mesh(frame)) for frame in frames])
    return areas / areas[tracked.rest] - 1.0


def _around_vertices_mm2(mesh: SurfaceMesh) -> np.ndarray:
    areas = np.repeat(triangle_areas_mm2(mesh), 3)
    return np.bincount(mesh.faces.ravel(), areas, len(mesh.vertices_mm))
