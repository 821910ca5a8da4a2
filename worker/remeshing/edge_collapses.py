"""Short edges drawn together to one vertex."""

import numpy as np

from worker.arrays import SomeFaces, SomePoints
from worker.remeshing.edges import Edges, edges_of, pair_keys

_LEAST_TURN = 0.3
"""Cosine by which a triangle may turn when a vertex of it moves."""

_FEWEST_NEIGHBOURS = 4
"""A vertex across from a collapsed edge loses a neighbour, and must have so many before."""


def collapse_edges(
    vertices: SomePoints, faces: SomeFaces, candidates: np.ndarray, *, may_fold: bool = False
) -> tuple[SomePoints, SomeFaces]:
    """Vertices and faces after some of the `candidates`, (e,) flags of the mesh's edges, are gone.

    Of candidates near each other the shortest goes, to its middle, and only where closedness and
    Euler number are kept (link condition) and no triangle folds over. Call again for the rest.
    may_fold: Do not look whether triangles fold over, as where they are folded already.
    """
    edges = edges_of(faces, len(vertices))
    chosen = np.flatnonzero(candidates)
    chosen = _linked_twice(edges, chosen, faces, len(vertices))
    chosen = _apart(edges, chosen, edges.lengths(vertices)[chosen], len(vertices))
    if not may_fold:
        chosen = _unfolded(vertices, faces, edges, chosen)
    if not len(chosen):
        return vertices, faces
    start, end = edges.start[chosen], edges.end[chosen]
    moved, renamed = vertices.copy(), np.arange(len(vertices))
    moved[start] = 0.5 * (vertices[start] + vertices[end])
    renamed[end] = start
    gone = np.zeros(len(faces), dtype=bool)
    gone[edges.here[chosen] // 3] = gone[edges.there[chosen] // 3] = True
    left = renamed[faces[~gone]]
    used, numbered = np.unique(left, return_inverse=True)
    return moved[used], numbered.reshape(left.shape)


def _linked_twice(edges: Edges, chosen: np.ndarray, faces: SomeFaces, count: int) -> np.ndarray:
    """Edges whose ends have no common neighbours but the two across, which can spare one."""
    degree = np.bincount(faces.ravel(), minlength=count)
    enough = np.minimum(degree[edges.left[chosen]], degree[edges.right[chosen]])
    chosen = chosen[enough >= _FEWEST_NEIGHBOURS]
    ends = np.concatenate([edges.start, edges.end])
    order = np.argsort(ends, kind="stable")
    neighbours = np.concatenate([edges.end, edges.start])[order]
    first = np.cumsum(degree) - degree
    # All neighbours of all starts, one after another.
    start, end = edges.start[chosen], edges.end[chosen]
    reach = degree[start]
    whose = np.repeat(np.arange(len(chosen)), reach)
    within = np.arange(reach.sum()) - np.repeat(np.cumsum(reach) - reach, reach)
    keys = pair_keys(neighbours[first[start][whose] + within], end[whose], count)
    place = np.minimum(np.searchsorted(edges.keys, keys), len(edges.keys) - 1)
    common = np.bincount(whose[edges.keys[place] == keys], minlength=len(chosen))
    return chosen[(common == 2) & (degree[start] + degree[end] - 4 >= 3)]


def _apart(edges: Edges, chosen: np.ndarray, lengths: np.ndarray, count: int) -> np.ndarray:
    """Edges that no shorter one of them, or of the same length and before, is near to.

    Near: an end of one is an end of the other, or a neighbour of it, or both lie across from one
    vertex.
    """
    rank = np.empty(len(chosen), dtype=np.int64)
    rank[np.argsort(lengths, kind="stable")] = np.arange(len(chosen))
    at_vertex = np.full(count, len(edges.keys))
    for ends in (edges.start, edges.end, edges.left, edges.right):
        np.minimum.at(at_vertex, ends[chosen], rank)
    around = at_vertex.copy()
    np.minimum.at(around, edges.start, at_vertex[edges.end])
    np.minimum.at(around, edges.end, at_vertex[edges.start])
    return chosen[(around[edges.start[chosen]] == rank) & (around[edges.end[chosen]] == rank)]


def _unfolded(
    vertices: SomePoints, faces: SomeFaces, edges: Edges, chosen: np.ndarray
) -> np.ndarray:
    owner = np.full(len(vertices), -1)
    moved = vertices.copy()
    middles = 0.5 * (vertices[edges.start[chosen]] + vertices[edges.end[chosen]])
    for ends in (edges.start[chosen], edges.end[chosen]):
        owner[ends] = np.arange(len(chosen))
        moved[ends] = middles
    owners = owner[faces]
    touched = (np.count_nonzero(owners >= 0, axis=1) == 1).nonzero()[0]
    before, after = vertices[faces[touched]], moved[faces[touched]]
    old = np.cross(before[:, 1] - before[:, 0], before[:, 2] - before[:, 0])
    new = np.cross(after[:, 1] - after[:, 0], after[:, 2] - after[:, 0])
    sizes = np.linalg.norm(old, axis=1) * np.linalg.norm(new, axis=1)
    folded = (old * new).sum(axis=1) < _LEAST_TURN * sizes
    kept = np.ones(len(chosen), dtype=bool)
    kept[owners[touched[folded]].max(axis=1)] = False
    return chosen[kept]
