"""Edges turned to the other diagonal of their two triangles, where that widens the angles."""

import numpy as np

from worker.arrays import Points, SomeFaces, SomePoints
from worker.remeshing.edges import Edges, edges_of, pair_keys

_WORTHWHILE = 1e-3
"""Gain in the cosine of the smallest angle that a flip is done for."""

_FLATNESS = 0.7
"""Cosine between a new triangle and its two old ones together: no flip across a fold."""

_FEWEST_NEIGHBOURS = 4
"""A vertex with fewer keeps all its edges, and one with as many gives one of them in a round."""


def flip_edges(vertices: SomePoints, faces: SomeFaces) -> SomeFaces:
    """Faces (m, 3) after flips of which no two touch one face. Call again for more.

    An edge is flipped when the smallest angle of its two triangles grows, none of them folds over,
    and its new ends were no neighbours before. Closedness and Euler number are kept.
    """
    edges = edges_of(faces, len(vertices))
    chosen, gains = _gainful(vertices, faces, edges)
    chosen, gains = _admissible(vertices, faces, edges, chosen, gains)
    chosen = _apart(faces, edges, chosen, gains, len(vertices))
    # Two flips must not make the same edge.
    left, right = edges.left[chosen], edges.right[chosen]
    _, first = np.unique(pair_keys(left, right, len(vertices)), return_index=True)
    chosen = chosen[np.sort(first)]
    start, end = edges.start[chosen], edges.end[chosen]
    left, right = edges.left[chosen], edges.right[chosen]
    flipped = faces.copy()
    flipped[edges.here[chosen] // 3] = np.stack([start, right, left], axis=1)
    flipped[edges.there[chosen] // 3] = np.stack([end, left, right], axis=1)
    return flipped


def narrowest_cosine(a: Points, b: Points, c: Points) -> np.ndarray:
    """Cosine of the smallest angle of each triangle, (n,); 1 for one without area."""
    ab, bc, ca = (_directions(end - start) for start, end in ((a, b), (b, c), (c, a)))
    return -np.minimum(
        np.minimum((ab * ca).sum(axis=1), (ab * bc).sum(axis=1)), (bc * ca).sum(axis=1)
    )


def _gainful(vertices: SomePoints, faces: SomeFaces, edges: Edges) -> tuple[np.ndarray, np.ndarray]:
    """Edges whose flip would widen the smallest angle, and by how much in its cosine."""
    corners = vertices[faces]
    # Cotangents of the angles across from the half-edges; a negative sum is not Delaunay.
    sides = np.roll(corners, -1, axis=1) - corners
    after, before = np.roll(sides, -1, axis=1), np.roll(sides, -2, axis=1)
    doubled = np.linalg.norm(np.cross(sides[:, 0], sides[:, 1]), axis=1)
    cotangents = -(after * before).sum(axis=2) / np.maximum(doubled, 1e-300)[:, None]
    cotangents = cotangents.ravel()
    chosen = np.flatnonzero(cotangents[edges.here] + cotangents[edges.there] < 0.0)
    start, end, left, right = (
        vertices[part[chosen]] for part in (edges.start, edges.end, edges.left, edges.right)
    )
    now = np.maximum(narrowest_cosine(start, end, left), narrowest_cosine(end, start, right))
    then = np.maximum(narrowest_cosine(start, right, left), narrowest_cosine(end, left, right))
    gainful = now - then > _WORTHWHILE
    return chosen[gainful], (now - then)[gainful]


def _admissible(
    vertices: SomePoints, faces: SomeFaces, edges: Edges, chosen: np.ndarray, gains: np.ndarray
) -> tuple[np.ndarray, np.ndarray]:
    start, end = edges.start[chosen], edges.end[chosen]
    left, right = edges.left[chosen], edges.right[chosen]
    neighbours = np.bincount(faces.ravel(), minlength=len(vertices))
    keys = pair_keys(left, right, len(vertices))
    place = np.minimum(np.searchsorted(edges.keys, keys), len(edges.keys) - 1)
    allowed = (edges.keys[place] != keys) & (left != right)
    allowed &= neighbours[start] >= _FEWEST_NEIGHBOURS
    allowed &= neighbours[end] >= _FEWEST_NEIGHBOURS
    a, b, c, d = vertices[start], vertices[end], vertices[left], vertices[right]
    old = _directions(np.cross(b - a, c - a) + np.cross(a - b, d - b))
    for new in (np.cross(d - a, c - a), np.cross(c - b, d - b)):
        allowed &= (_directions(new) * old).sum(axis=1) > _FLATNESS
    return chosen[allowed], gains[allowed]


def _apart(
    faces: SomeFaces, edges: Edges, chosen: np.ndarray, gains: np.ndarray, vertex_count: int
) -> np.ndarray:
    """Of the edges of a face, and of those of a vertex that can spare one, what gains most."""
    # Ranks, since gains may be equal.
    rank = np.empty(len(chosen), dtype=np.int64)
    rank[np.argsort(gains, kind="stable")] = np.arange(1, len(chosen) + 1)
    of_face, of_vertex = np.zeros(len(faces), np.int64), np.zeros(vertex_count, np.int64)
    beside = (edges.here[chosen] // 3, edges.there[chosen] // 3)
    ends = (edges.start[chosen], edges.end[chosen])
    for face, vertex in zip(beside, ends, strict=True):
        np.maximum.at(of_face, face, rank)
        np.maximum.at(of_vertex, vertex, rank)
    neighbours = np.bincount(faces.ravel(), minlength=vertex_count)
    kept = np.ones(len(chosen), dtype=bool)
    for face, vertex in zip(beside, ends, strict=True):
        kept &= of_face[face] == rank
        kept &= (neighbours[vertex] > _FEWEST_NEIGHBOURS) | (of_vertex[vertex] == rank)
    return chosen[kept]


def _directions(vectors: Points) -> Points:
    return vectors / np.maximum(np.linalg.norm(vectors, axis=1, keepdims=True), 1e-300)
