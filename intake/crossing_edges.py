"""Which edges of an outline cross each other."""

from collections.abc import Sequence

import numpy as np
from numpy.typing import NDArray

from intake.edges import batches, edges_of

Array = NDArray[np.float64]
Indices = NDArray[np.intp]

Outline = tuple[Array, bool]
"""Points (n, 2), n >= 2, and whether the last joins the first."""

Found = tuple[Indices, Indices] | None

_ODD_ANGLE = 0.6180339887
"""Radians: pixel outlines have runs of level edges, which this turns into disjoint intervals."""

_PAIRS_AN_EDGE = 50
"""Candidates an edge before the search is given up: a heart's outline has about four."""

_EDGES_AT_ONCE = 8192

_GAP = 1.0
"""Between outlines side by side: far more than rounding moves them."""


def crossing_edges(outlines: Sequence[Outline]) -> list[Found]:
    """Of each outline, pairs (i, j), i < j, of edges that properly cross; edge i leaves point i.

    Edges that touch, overlap or share an end do not count. Answers None for an outline that is so
    tangled that looking at every candidate would cost too much.
    """
    sizes = [len(points) for points, _ in outlines]
    return [one for run in batches(sizes, _EDGES_AT_ONCE) for one in _together(outlines[run])]


def _together(outlines: Sequence[Outline]) -> list[Found]:
    edges = edges_of([points for points, _ in outlines])
    counts = np.array([len(points) for points, _ in outlines])
    starts = np.cumsum(counts) - counts
    is_edge = np.ones(len(edges.start), dtype=np.bool_)
    is_open = np.array([not closed for _, closed in outlines])
    is_edge[(starts + counts - 1)[is_open]] = False
    (at,) = np.nonzero(is_edge)
    a, b, outline = edges.start[at], edges.end[at], edges.ring[at]
    low, high = _apart(a, b, outline)
    order = np.argsort(low, kind="stable")
    low, high, outline = low[order], high[order], outline[order]
    # Sorted by their left ends, the edges that overlap edge k to its right follow it in a run.
    spans = np.searchsorted(low, high, side="right") - np.arange(1, len(low) + 1)
    candidates = np.bincount(outline, weights=spans, minlength=len(outlines))
    edge_counts = np.bincount(outline, minlength=len(outlines))
    tangled = candidates > _PAIRS_AN_EDGE * edge_counts + 10_000
    spans[tangled[outline]] = 0
    first = np.repeat(np.arange(len(low)), spans)
    second = first + 1 + np.arange(len(first)) - np.repeat(np.cumsum(spans) - spans, spans)
    i, j = order[first], order[second]
    ai, bi, aj, bj = a[i], b[i], a[j], b[j]
    crosses = (_side(ai, bi, aj) * _side(ai, bi, bj) < 0) & (
        _side(aj, bj, ai) * _side(aj, bj, bi) < 0
    )
    of = outline[first[crosses]]
    i, j = at[i[crosses]] - starts[of], at[j[crosses]] - starts[of]
    least, most = np.minimum(i, j), np.maximum(i, j)
    return [None if tangled[k] else (least[of == k], most[of == k]) for k in range(len(outlines))]


def _apart(a: Array, b: Array, outline: Indices) -> tuple[Array, Array]:
    """The edges' intervals on a line at an odd angle, each outline's beyond the last one's."""
    direction = np.array([np.cos(_ODD_ANGLE), np.sin(_ODD_ANGLE)])
    xa, xb = a @ direction, b @ direction
    low, high = np.minimum(xa, xb), np.maximum(xa, xb)
    firsts = np.flatnonzero(np.diff(outline, prepend=-1))
    left, right = np.minimum.reduceat(low, firsts), np.maximum.reduceat(high, firsts)
    width = 1.001 * (right - left) + _GAP
    shift = (np.cumsum(width) - width - left)[outline]
    return low + shift, high + shift


def _side(a: Array, b: Array, p: Array) -> Array:
    """Sign of the side of line a-b on which p is; points (k, 2)."""
    u, v = b - a, p - a
    turn = u[:, 0] * v[:, 1] - u[:, 1] * v[:, 0]
    # What rounding alone produces is a touch, not a crossing.
    scale = np.abs(u).max(axis=1) * np.abs(v).max(axis=1)
    sign: Array = np.where(np.abs(turn) <= 1e-9 * scale, 0.0, np.sign(turn))
    return sign
