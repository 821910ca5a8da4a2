"""A fine triangulation thinned out until its edges have a chosen length."""

import math

import igl
import numpy as np
from jaxtyping import Float

from worker.arrays import SomeFaces, SomePoints
from worker.observer import Cancelled, Observer

_NORMAL_WEIGHT = 0.7
"""Length of a normal beside a position, in target edges, when edges are measured for decimation:
across a ridge they count longer, so that its triangles are smaller and it survives."""

_FEWEST_FACES = 64
_FACES_AT_ONCE = 40_000
"""Faces taken away between two looks at the observer: a fraction of a second."""

WithNormals = Float[np.ndarray, "_ 6"]
"""Positions, and normals times a length."""


def decimate(
    vertices: SomePoints, faces: SomeFaces, edge: float, observer: Observer
) -> tuple[SomePoints, SomeFaces]:
    """Vertices and faces of a closed mesh, its shortest edges collapsed until the rest are `edge`
    long, or as it is when it is no finer (libigl). Closedness and Euler number are kept.

    Raises Cancelled when the observer asks to stop.
    """
    normals = igl.per_vertex_normals(vertices, faces)
    points: WithNormals = np.hstack([vertices, _NORMAL_WEIGHT * edge * normals])
    # Equilateral triangles have the area sqrt(3)/4 edge^2.
    wanted = int(_area(points, faces) / (0.25 * math.sqrt(3.0) * edge**2))
    wanted = max(wanted, _FEWEST_FACES)
    while len(faces) > wanted:
        if observer.is_cancelled():
            raise Cancelled
        before = len(faces)
        points, faces, _, _ = igl.decimate(points, faces, max(wanted, before - _FACES_AT_ONCE))
        if len(faces) >= before:
            break
    return np.ascontiguousarray(points[:, :3]), faces.astype(np.int64)


def _area(points: WithNormals, faces: SomeFaces) -> float:
    """Area of all triangles, in any number of dimensions (Heron)."""
    a, b, c = (
        np.linalg.norm(points[faces[:, i]] - points[faces[:, j]], axis=1)
        for i, j in ((0, 1), (1, 2), (2, 0))
    )
    half = 0.5 * (a + b + c)
    return float(np.sqrt(np.maximum(half * (half - a) * (half - b) * (half - c), 0.0)).sum())
