"""Edges of many rings as one array, so that a whole study is judged by a few array operations."""

from collections.abc import Sequence
from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

Array = NDArray[np.float64]
Indices = NDArray[np.intp]

_SMALL = 1e-12
"""mm: what is not longer has no length."""


@dataclass(frozen=True, eq=False)
class Edges:
    """Edge i goes from `start[i]` (n, d) to the start of edge `following[i]` on ring `ring[i]`."""

    start: Array
    following: Indices
    ring: Indices

    @property
    def end(self) -> Array:
        """(n, d)"""
        return self.start[self.following]


def edges_of(rings: Sequence[Array]) -> Edges:
    """The edges of `rings`, each (m, d) with m >= 1; a ring's last point joins its first."""
    counts = np.array([len(ring) for ring in rings])
    start = np.concatenate(rings)
    following = np.arange(1, len(start) + 1)
    ends = np.cumsum(counts)
    following[ends - 1] = ends - counts
    return Edges(start, following, np.repeat(np.arange(len(rings)), counts))


def batches(sizes: Sequence[int], most: int) -> list[slice]:
    """Runs of neighbours, as many as sum to `most` at most; one that is larger is alone."""
    found, start, total = [], 0, 0
    for at, size in enumerate(sizes):
        if at > start and total + size > most:
            found.append(slice(start, at))
            start, total = at, 0
        total += size
    if len(sizes) > start:
        found.append(slice(start, len(sizes)))
    return found


def order_along(line: Indices, x: Array) -> Indices:
    """The order (n,) of crossings by their line and, on each, by where they are.

    As `np.lexsort` has it, but for crossings within rounding of one another: ten times as fast.
    """
    if not len(x):
        return np.empty(0, dtype=np.intp)
    left, right = x.min(), x.max()
    return np.argsort(line + 0.5 * (x - left) / max(right - left, _SMALL))
