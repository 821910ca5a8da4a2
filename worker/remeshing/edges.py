"""The edges of a closed triangulation, each once, with the two faces beside it."""

from dataclasses import dataclass

import numpy as np
from jaxtyping import Int

from worker.arrays import Faces, Points

Indices = Int[np.ndarray, " e"]
"""One index an edge."""


@dataclass(frozen=True, eq=False)
class Edges:
    """Every edge of a closed, consistently oriented triangulation.

    here, there: its two half-edges, 3 * face + corner; a half-edge runs from that corner to the
        next one of the face.
    start, end: the vertices that `here` runs between.
    left, right: the vertices across from the edge, in the faces of `here` and of `there`.
    keys: ascending, one a pair of vertices.
    """

    here: Indices
    there: Indices
    start: Indices
    end: Indices
    left: Indices
    right: Indices
    keys: Indices

    def lengths(self, vertices: Points) -> np.ndarray:
        """(e,) in the unit of the vertices."""
        return np.linalg.norm(vertices[self.end] - vertices[self.start], axis=1)


def edges_of(faces: Faces, vertex_count: int) -> Edges:
    """All edges. Raises ValueError where an edge has not one face on either side."""
    starts = faces.ravel()
    ends = np.roll(faces, -1, axis=1).ravel()
    across = np.roll(faces, -2, axis=1).ravel()
    keys = pair_keys(starts, ends, vertex_count)
    order = np.argsort(keys, kind="stable")
    if len(order) % 2 or not len(order):
        raise ValueError("the triangulation is not closed")
    here, there = order[::2], order[1::2]
    unpaired = (keys[here] != keys[there]) | (starts[here] != ends[there])
    unique = keys[here]
    if unpaired.any() or (unique[1:] == unique[:-1]).any():
        raise ValueError("the triangulation is not closed, or not consistently oriented")
    return Edges(here, there, starts[here], ends[here], across[here], across[there], unique)


def pair_keys(a: Indices, b: Indices, vertex_count: int) -> Indices:
    """One number for each pair of vertices, whichever comes first."""
    return np.minimum(a, b) * vertex_count + np.maximum(a, b)
