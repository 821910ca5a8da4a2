"""A mesh that moves, thinned out for the screen once for all frames."""

from collections.abc import Sequence

import igl
import numpy as np
from jaxtyping import Float

from worker.arrays import Faces
from worker.artifacts.page.display_mesh import display_mesh
from worker.evaluation.distance import nearest_on_surface
from worker.surface_mesh import SurfaceMesh


def thinned_motion(
    meshes: Sequence[SurfaceMesh], triangles: int
) -> tuple[Float[np.ndarray, "frames n 3"], Faces]:
    """Vertices, mm, frame by frame, and faces, of meshes with the same triangles: about so many.

    What is left of the first mesh is carried along with the triangles that it lies on.
    """
    first = meshes[0]
    thin = display_mesh(first, triangles)
    if thin is first:
        return np.stack([mesh.vertices_mm for mesh in meshes]), first.faces
    places, on = nearest_on_surface(thin.vertices_mm, first)
    corners = np.ascontiguousarray(np.moveaxis(first.triangles_mm[on], 1, 0))
    shares = igl.barycentric_coordinates(places, corners[0], corners[1], corners[2])
    moved = [np.einsum("nc,ncx->nx", shares, mesh.triangles_mm[on]) for mesh in meshes]
    return np.stack(moved), thin.faces
