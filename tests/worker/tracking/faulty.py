"""Round meshes, and the same with a fault."""

import numpy as np

from tests.worker.tracking.ellipsoids import sphere
from worker.surface_mesh import SurfaceMesh

RADIUS_MM = 20.0


def ball(radius_mm: float = RADIUS_MM) -> SurfaceMesh:
    vertices, faces = sphere()
    return SurfaceMesh(radius_mm * vertices / np.linalg.norm(vertices, axis=1)[:, None], faces)


def with_a_fold(mesh: SurfaceMesh, vertex: int = 100) -> SurfaceMesh:
    """The vertex drawn over the far side of a neighbour's triangles."""
    face = mesh.faces[(mesh.faces == vertex).any(axis=1)][0]
    neighbour = int(face[face != vertex][0])
    vertices = mesh.vertices_mm.copy()
    vertices[vertex] += 2.5 * (vertices[neighbour] - vertices[vertex])
    return SurfaceMesh(vertices, mesh.faces)


def with_a_fin(mesh: SurfaceMesh, depth: int = 10, height_mm: float = 8.0) -> SurfaceMesh:
    """A face in three, one of these in three, and so on, the new vertices in and out by turns: what
    stands on so narrow a foot, no smoothing lays flat without needles.
    """
    vertices, faces = list(mesh.vertices_mm), mesh.faces.tolist()
    face = faces.pop(0)
    for step in range(depth):
        a, b, c = face
        middle = np.mean([vertices[k] for k in face], axis=0)
        outward = middle / np.linalg.norm(middle)
        vertices.append(middle + (-1) ** step * height_mm * outward)
        new = len(vertices) - 1
        faces += [[a, b, new], [b, c, new]]
        face = [c, a, new]
    faces.append(face)
    return SurfaceMesh(np.array(vertices), np.array(faces))
