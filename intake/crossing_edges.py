"""Which edges of an outline cross each other."""

import numpy as np
from numpy.typing import NDArray

from intake.even_odd import following

Array = NDArray[np.float64]
Indices = NDArray[np.intp]

_ODD_ANGLE = 0.6180339887
"""Radians: pixel outlines have runs of level edges, which this turns into disjoint intervals."""

_PAIRS_AN_EDGE = 50
"""Candidates an edge before the search is given up: a heart's outline has about four."""


def crossing_edges(points: Array, closed: bool) -> tuple[Indices, Indices] | None:
    """Pairs (i, j), i < j, of edges that properly cross; edge i leaves point i of `points` (n, 2).

    Edges that touch, overlap or share an end do not count. Answers None when the outline is so
    tangled that looking at every candidate would cost too much.
    """
    a = points if closed else points[:-1]
    b = following(points)[: len(a)]
    c, s = np.cos(_ODD_ANGLE), np.sin(_ODD_ANGLE)
    xa, xb = a @ np.array([c, s]), b @ np.array([c, s])
    order = np.argsort(np.minimum(xa, xb), kind="stable")
    low, high = np.minimum(xa, xb)[order], np.maximum(xa, xb)[order]
    # Sorted by their left ends, the edges that overlap edge k to its right follow it in a run.
    spans = np.searchsorted(low, high, side="right") - np.arange(1, len(low) + 1)
    if spans.sum() > _PAIRS_AN_EDGE * len(low) + 10_000:
        return None
    first = np.repeat(np.arange(len(low)), spans)
    second = first + 1 + np.arange(len(first)) - np.repeat(np.cumsum(spans) - spans, spans)
    i, j = order[first], order[second]
    crosses = (_side(a[i], b[i], a[j]) * _side(a[i], b[i], b[j]) < 0) & (
        _side(a[j], b[j], a[i]) * _side(a[j], b[j], b[i]) < 0
    )
    i, j = i[crosses], j[crosses]
    return np.minimum(i, j), np.maximum(i, j)


def _side(a: Array, b: Array, p: Array) -> Array:
    """Sign of the side of line a-b on which p is; points (k, 2)."""
    u, v = b - a, p - a
    turn = u[:, 0] * v[:, 1] - u[:, 1] * v[:, 0]
    # What rounding alone produces is a touch, not a crossing.
    scale = np.abs(u).max(axis=1) * np.abs(v).max(axis=1)
    sign: Array = np.where(np.abs(turn) <= 1e-9 * scale, 0.0, np.sign(turn))
    return sign
