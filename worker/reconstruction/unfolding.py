"""Triangles that turned over while their vertices moved, put back."""

import numpy as np

from worker.arrays import Faces, Points, SomePoints

_TURNED = 0.3
"""Cosine between a triangle's normals before and after, below which it has turned over."""

_MOST_ROUNDS = 20
"""Each puts back the triangles that the one before has turned; two are usual."""


def unfolded(before: Points, after: Points, faces: Faces) -> Points:
    """Vertices (n, 3) as in `after`, but as in `before` at the corners of triangles that turned.

    Where a surface has an edge thinner than its triangles, vertices of both sides are drawn past
    one another, and the surface folds over. `before` is free of folds.
    """
    normals = _normals(before, faces)
    vertices = after.copy()
    for _ in range(_MOST_ROUNDS):
        turned = np.einsum("md,md->m", _normals(vertices, faces), normals) < _TURNED
        back = np.unique(faces[turned])
        if (vertices[back] == before[back]).all():
            break
        vertices[back] = before[back]
    return vertices


def _normals(vertices: Points, faces: Faces) -> SomePoints:
    a, b, c = (vertices[faces[:, corner]] for corner in range(3))
    across = np.cross(b - a, c - a)
    return across / np.maximum(np.linalg.norm(across, axis=1, keepdims=True), 1e-30)
