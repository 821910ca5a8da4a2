"""Areas of even-odd fills, and of what two of them share.

All pairs of a study are measured together: each alone is so little work that calling numpy for it
would take most of the time.
"""

from collections.abc import Sequence
from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

from intake.edges import batches, edges_of, order_along
from intake.even_odd import widths

Array = NDArray[np.float64]

Fill = Sequence[Array]
"""Rings, each (m, 2), mm, whose even-odd fill is meant; no ring, no fill."""

_LINES = 128
"""Scan lines over the first fill: exact along a line, an error of about 1e-3 of the area across."""

_EDGES_AT_ONCE = 8192
_CROSSINGS_AT_ONCE = 128 * _EDGES_AT_ONCE
"""Bound the memory of one step: about 100 MB."""


@dataclass(frozen=True)
class Overlap:
    """How much of a fill lies in another, mm^2."""

    area_mm2: float
    shared_mm2: float

    @property
    def share(self) -> float:
        """Part of the fill that lies in the other; 0 for a fill without area."""
        return self.shared_mm2 / self.area_mm2 if self.area_mm2 else 0.0

    @property
    def outside_mm2(self) -> float:
        return self.area_mm2 - self.shared_mm2


def overlap(rings: Fill, others: Fill) -> Overlap:
    """Area of the even-odd fill of `rings`, and of its part inside that of `others`."""
    return overlaps([(rings, others)])[0]


def overlaps(pairs: Sequence[tuple[Fill, Fill]]) -> list[Overlap]:
    """The same of many pairs; the first of each has a ring."""
    sizes = [sum(len(ring) for ring in (*rings, *others)) for rings, others in pairs]
    return [one for run in batches(sizes, _EDGES_AT_ONCE) for one in _together(pairs[run])]


def _together(pairs: Sequence[tuple[Fill, Fill]]) -> list[Overlap]:
    scan = _Scan(pairs)
    lines = max(1, min(_LINES, _CROSSINGS_AT_ONCE // len(scan.pair)))
    area, shared = np.zeros(len(pairs)), np.zeros(len(pairs))
    for line in range(0, _LINES, lines):
        of_line, shared_of_line = scan.areas(line, min(line + lines, _LINES))
        area += of_line
        shared += shared_of_line
    return [Overlap(*both) for both in zip(area.tolist(), shared.tolist(), strict=True)]


class _Scan:
    """Pairs of fills under scan lines: `_LINES` over the height of each pair's first fill.

    Heights are counted in lines: line k of a pair lies at height k.
    """

    def __init__(self, pairs: Sequence[tuple[Fill, Fill]]) -> None:
        edges = edges_of([ring for pair in pairs for fill in pair for ring in fill])
        counts = [(len(rings), len(others)) for rings, others in pairs]
        pair_of = np.repeat(np.arange(len(pairs)), [sum(count) for count in counts])
        is_first = np.repeat([True, False] * len(pairs), [n for count in counts for n in count])
        self.pair, self._is_first = pair_of[edges.ring], is_first[edges.ring]
        firsts = [np.concatenate([ring[:, 1] for ring in rings]) for rings, _ in pairs]
        bottom = np.array([y.min() for y in firsts])
        self._step = (np.array([y.max() for y in firsts]) - bottom) / _LINES
        step = np.where(self._step > 0.0, self._step, 1.0)[self.pair]
        with np.errstate(over="ignore"):  # far from a fill that has next to no height
            start = (edges.start[:, 1] - bottom[self.pair]) / step - 0.5
        end = start[edges.following]
        # Lower and upper end of every edge, so that both directions compute alike.
        swap = start > end
        low, high = np.where(swap, end, start), np.where(swap, start, end)
        first_line, last_line = np.clip(np.ceil(low), 0, _LINES), np.clip(np.ceil(high), 0, _LINES)
        self._first_line, self._last_line = first_line.astype(np.intp), last_line.astype(np.intp)
        start_x, end_x = edges.start[:, 0], edges.end[:, 0]
        self._low, self._height = low, high - low
        self._x = np.where(swap, end_x, start_x)
        self._width = np.where(swap, start_x, end_x) - self._x

    def areas(self, line: int, stop: int) -> tuple[Array, Array]:
        """Of each pair, mm^2 of fill and shared part that lines from `line` to `stop` see."""
        first = np.clip(self._first_line, line, stop)
        spans = np.clip(self._last_line, line, stop) - first
        edge = np.repeat(np.arange(len(spans)), spans)
        row = np.arange(len(edge)) - np.repeat(np.cumsum(spans) - spans - first, spans)
        # A fraction first: a slope would overflow on a nearly level edge.
        up = (row - self._low[edge]) / self._height[edge]
        x = self._x[edge] + up * self._width[edge]
        pair = self.pair[edge]
        order = order_along(row + _LINES * pair, x)
        is_first, pair = self._is_first[edge][order], pair[order]
        # Every line crosses a ring an even number of times, so the parities may run on over all.
        in_first, in_other = np.cumsum(is_first) % 2 == 1, np.cumsum(~is_first) % 2 == 1
        steps = widths(x[order]) * in_first
        area = np.bincount(pair, weights=steps, minlength=len(self._step))
        shared = np.bincount(pair, weights=steps * in_other, minlength=len(self._step))
        return area * self._step, shared * self._step
