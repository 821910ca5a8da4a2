"""Vertices slid along the surface until the triangles are even."""

import numpy as np

from worker.arrays import Faces, Points
from worker.remeshing.edge_flips import narrowest_cosine
from worker.remeshing.edges import edges_of

_STEP = 0.8
"""Part of the way to the middle of the surrounding triangles."""

_CREASE = 0.1
"""Variance of the normals around a vertex along a direction, by which it may no longer move: it
would slide off the ridge that it holds up. After Jiao and others, null-space smoothing."""

_NARROW = np.cos(np.radians(30.0))
"""A vertex of a triangle narrower than this moves whatever the ridge: even triangles first."""

_LEAST_TURN = 0.5
"""Cosine by which a triangle may turn in one step; the vertices of others stay."""


def relax(vertices: Points, faces: Faces) -> Points:
    """Vertices (n, 3) of a closed mesh after one step along its tangent planes.

    Each goes towards the area-weighted middle of its triangles, areas measured in the length of
    edges around, so that what is fine stays fine. It leaves the surface in second order only.
    """
    corners = vertices[faces]
    doubled = np.cross(corners[:, 1] - corners[:, 0], corners[:, 2] - corners[:, 0])
    areas = np.linalg.norm(doubled, axis=1)
    normals = doubled / np.maximum(areas, 1e-300)[:, None]
    size = _edge_lengths(vertices, faces)
    middles = _around(faces, corners.mean(axis=1), areas / size[faces].mean(axis=1) ** 3, size)
    moved = vertices + _STEP * _along_surface(vertices, faces, normals, areas, middles - vertices)
    for _ in range(3):
        corners = moved[faces]
        turned = np.cross(corners[:, 1] - corners[:, 0], corners[:, 2] - corners[:, 0])
        lengths = np.maximum(np.linalg.norm(turned, axis=1), 1e-300)
        folded = (turned * normals).sum(axis=1) < _LEAST_TURN * lengths
        if not folded.any():
            break
        stays = faces[folded].ravel()
        moved[stays] = vertices[stays]
    return moved


def _edge_lengths(vertices: Points, faces: Faces) -> np.ndarray:
    """Mean length of the edges at each vertex, (n,)."""
    edges = edges_of(faces, len(vertices))
    ends = np.concatenate([edges.start, edges.end])
    lengths = np.tile(edges.lengths(vertices), 2)
    counts = np.bincount(ends, minlength=len(vertices))
    return np.bincount(ends, lengths, len(vertices)) / np.maximum(counts, 1)


def _around(faces: Faces, values: np.ndarray, weights: np.ndarray, like: np.ndarray) -> np.ndarray:
    """Weighted mean over the faces at each vertex of (m, k) values of faces: (n, k)."""
    size, at = len(like), faces.ravel()
    total = np.bincount(at, np.repeat(weights, 3), size)
    sums = [np.bincount(at, np.repeat(weights * column, 3), size) for column in values.T]
    return np.stack(sums, axis=1) / np.maximum(total, 1e-300)[:, None]


def _along_surface(
    vertices: Points, faces: Faces, normals: np.ndarray, areas: np.ndarray, offset: Points
) -> Points:
    """What of `offset` (n, 3) lies in directions along which the surface is flat."""
    outer = (normals[:, :, None] * normals[:, None, :]).reshape(-1, 9)
    tensors = _around(faces, outer, areas, vertices).reshape(-1, 3, 3)
    variances, axes = np.linalg.eigh(tensors)
    free = np.clip(1.0 - variances / _CREASE, 0.0, 1.0)
    corners = vertices[faces]
    narrow = narrowest_cosine(corners[:, 0], corners[:, 1], corners[:, 2]) > _NARROW
    free[faces[narrow].ravel(), :2] = 1.0
    # The direction of the most variance is the normal itself.
    free[:, 2] = 0.0
    along = np.einsum("nik,ni->nk", axes, offset) * free
    return np.einsum("nik,nk->ni", axes, along)
