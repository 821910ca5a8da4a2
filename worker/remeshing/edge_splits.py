"""Edges divided at their middles, any number at once."""

import numpy as np

from worker.arrays import SomeFaces, SomePoints
from worker.remeshing.edges import Edges


def split_edges(
    vertices: SomePoints, faces: SomeFaces, edges: Edges, chosen: np.ndarray
) -> tuple[SomePoints, SomeFaces]:
    """Vertices and faces with a vertex at the middle of each chosen edge, after those there were.

    chosen: (e,) flags of `edges`. A face is divided in two, three or four by how many of its edges
    are. Closedness and Euler number are kept.
    """
    count = int(chosen.sum())
    middles = 0.5 * (vertices[edges.start[chosen]] + vertices[edges.end[chosen]])
    on_half_edge = np.full(3 * len(faces), -1)
    for half_edges in (edges.here, edges.there):
        on_half_edge[half_edges[chosen]] = len(vertices) + np.arange(count)
    added = on_half_edge.reshape(-1, 3)
    grown = np.concatenate([vertices, middles])
    divided = np.count_nonzero(added >= 0, axis=1)
    parts = [
        faces[divided == 0],
        *_in_two(faces[divided == 1], added[divided == 1]),
        *_in_three(grown, faces[divided == 2], added[divided == 2]),
        *_in_four(faces[divided == 3], added[divided == 3]),
    ]
    return grown, np.concatenate(parts)


def _in_two(faces: SomeFaces, added: SomeFaces) -> list[SomeFaces]:
    (a, b, c), (middle, _, _) = _from_corner(faces, added, np.argmax(added >= 0, axis=1))
    return [_stacked(a, middle, c), _stacked(middle, b, c)]


def _in_three(vertices: SomePoints, faces: SomeFaces, added: SomeFaces) -> list[SomeFaces]:
    """Cut off the corner between the divided edges, and what is left along its shorter diagonal."""
    first = (np.argmax(added < 0, axis=1) + 1) % 3
    (a, b, c), (ab, bc, _) = _from_corner(faces, added, first)
    from_a = np.linalg.norm(vertices[a] - vertices[bc], axis=1)
    from_c = np.linalg.norm(vertices[c] - vertices[ab], axis=1)
    shorter = (from_a < from_c)[:, None]
    return [
        _stacked(ab, b, bc),
        np.where(shorter, _stacked(a, ab, bc), _stacked(a, ab, c)),
        np.where(shorter, _stacked(a, bc, c), _stacked(ab, bc, c)),
    ]


def _in_four(faces: SomeFaces, added: SomeFaces) -> list[SomeFaces]:
    (a, b, c), (ab, bc, ca) = faces.T, added.T
    return [_stacked(a, ab, ca), _stacked(ab, b, bc), _stacked(ca, bc, c), _stacked(ab, bc, ca)]


def _from_corner(
    faces: SomeFaces, added: SomeFaces, first: np.ndarray
) -> tuple[np.ndarray, np.ndarray]:
    """Corners and edge middles of each face, (3, m) each, counted from its corner `first`."""
    order = (first[:, None] + np.arange(3)) % 3
    return np.take_along_axis(faces, order, axis=1).T, np.take_along_axis(added, order, axis=1).T


def _stacked(a: np.ndarray, b: np.ndarray, c: np.ndarray) -> SomeFaces:
    return np.stack([a, b, c], axis=1)
