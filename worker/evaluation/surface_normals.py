"""Which way a surface faces."""

import numpy as np

from worker.arrays import Points
from worker.evaluation.distance import nearest_on_surface
from worker.surface_mesh import SurfaceMesh


def vertex_normals(mesh: SurfaceMesh) -> Points:
    """Unit normals at the vertices, (n, 3), outward for an outward mesh: the mean of the triangles
    about each, weighed by area. Zero at a vertex without a triangle that has area.
    """
    corners = mesh.triangles_mm
    across = np.cross(corners[:, 1] - corners[:, 0], corners[:, 2] - corners[:, 0])
    sums = np.zeros((len(mesh.vertices_mm), 3))
    np.add.at(sums, mesh.faces, np.repeat(across[:, None], 3, axis=1))
    return unit(sums)


def normals_at(points_mm: Points, mesh: SurfaceMesh) -> Points:
    """Unit normals, (n, 3), where `mesh` is nearest to each of (n, 3) points, n at least 1.

    The mean of the corners of that triangle, which is steadier than the triangle's own on thin
    triangles. Raises InternalError when the mesh has no faces.
    """
    _, faces = nearest_on_surface(points_mm, mesh)
    return unit(vertex_normals(mesh)[mesh.faces[faces]].sum(axis=1))


def unit(vectors: Points) -> Points:
    """Vectors (n, 3) at length one; those of length zero stay."""
    lengths = np.linalg.norm(vectors, axis=1, keepdims=True)
    return vectors / np.where(lengths > 0.0, lengths, 1.0)
