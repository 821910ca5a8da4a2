"""Even-odd fill: which points of a plane lie inside a set of outlines."""

from collections.abc import Iterator, Sequence

import numpy as np
from numpy.typing import NDArray

Array = NDArray[np.float64]
Indices = NDArray[np.intp]

_PAIRS_AT_ONCE = 1_000_000
"""Bounds the memory of one step: about 50 MB."""


def inside(points: Array, rings: Sequence[Array]) -> NDArray[np.bool_]:
    """Whether each of `points` (n, 2) is inside the even-odd fill of `rings`, each (m, 2).

    A ring's last point joins its first; repeating the first is harmless. A ring within a ring is a
    hole. No ring: nothing is inside. On the boundary: left and lower edges are inside, right and
    upper edges outside, so regions that tile the plane share out every point exactly once.
    """
    points = np.asarray(points, dtype=np.float64)
    order = np.argsort(points[:, 1], kind="stable")
    x, heights = points[order, 0], points[order, 1]
    count = np.zeros(len(points), dtype=np.intp)
    for rows, at in crossings(rings, heights):
        count += np.bincount(rows[x[rows] < at], minlength=len(points))
    answer = np.empty(len(points), dtype=np.bool_)
    answer[order] = count % 2 == 1
    return answer


def crossings(rings: Sequence[Array], heights: Array) -> Iterator[tuple[Indices, Array]]:
    """Where horizontal lines at ascending `heights` (n,) cross the rings, in blocks.

    Yields the lines' indices (k,) and the abscissae (k,), in no order. Only the edges that span a
    height are looked at: they are a run in the sorted heights, found by bisection.
    """
    low, high = _edges(rings)
    first = np.searchsorted(heights, low[:, 1], side="left")
    spans = np.searchsorted(heights, high[:, 1], side="left") - first
    ends = np.cumsum(spans)
    start = 0
    while start < len(low):
        done = ends[start - 1] if start else 0
        stop = max(start + 1, int(np.searchsorted(ends, done + _PAIRS_AT_ONCE, side="right")))
        edge = np.repeat(np.arange(start, stop), spans[start:stop])
        row = np.arange(len(edge)) - (ends[edge] - spans[edge] - done) + first[edge]
        # A fraction first: a slope would overflow on a nearly level edge.
        up = (heights[row] - low[edge, 1]) / (high[edge, 1] - low[edge, 1])
        yield row, low[edge, 0] + up * (high[edge, 0] - low[edge, 0])
        start = stop


def following(ring: Array) -> Array:
    """Each point's successor (n, ...) on a ring (n, ...); `np.roll` takes three times as long."""
    return np.concatenate([ring[1:], ring[:1]])


def widths(ends: Array) -> Array:
    """From each of ascending ends (k,) to the next; what is said of the last means nothing."""
    return np.concatenate([ends[1:], [0.0]]) - ends


def _edges(rings: Sequence[Array]) -> tuple[Array, Array]:
    """Lower and upper end (m, 2) of every edge, so that both directions compute alike."""
    starts = [np.asarray(ring, dtype=np.float64).reshape(-1, 2) for ring in rings]
    if not starts:
        return np.empty((0, 2)), np.empty((0, 2))
    a = np.concatenate(starts)
    b = np.concatenate([following(ring) for ring in starts])
    swap = (a[:, 1] > b[:, 1])[:, None]
    return np.where(swap, b, a), np.where(swap, a, b)
