"""Which way a surface faces."""

import numpy as np

from worker.arrays import Points
from worker.evaluation.distance import nearest_on_surface
from worker.surface_mesh import SurfaceMesh


def vertex_normals(mesh: SurfaceMesh) -> Points:
    """Unit normals at the vertices, (n, 3), outward for an outward mesh: the mean of the triangles
    about each, weighed by area. Zero at a vertex without a triangle that has area.
    """
    first, second, third = (mesh.vertices_mm[mesh.faces[:, corner]] for corner in range(3))
    across = np.cross(second - first, third - first)
    at, count = mesh.faces.ravel(), len(mesh.vertices_mm)
    sums = [np.bincount(at, np.repeat(axis, 3), count) for axis in across.T]
    return unit(np.stack(sums, axis=1))


def normals_at(points_mm: Points, mesh: SurfaceMesh) -> Points:
    """Unit normals, (n, 3), where `mesh` is nearest to each of (n, 3) points, n at least 1.

    The mean of the corners of that triangle, which is steadier than the triangle's own on thin
    triangles. Raises InternalError when the mesh has no faces.
    """
    _, faces = nearest_on_surface(points_mm, mesh)
    return unit(vertex_normals(mesh)[mesh.faces[faces]].sum(axis=1))


def unit(vectors: Points) -> Points:
    """Vectors (n, 3) at length one; those of length zero stay."""
    lengths = np.sqrt(np.einsum("nd,nd->n", vectors, vectors))[:, None]
    return vectors / np.where(lengths > 0.0, lengths, 1.0)
