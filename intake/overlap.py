"""Areas of even-odd fills, and of what two of them share."""

from collections.abc import Sequence
from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

from intake.even_odd import crossings, widths

Array = NDArray[np.float64]

_LINES = 128
"""Scan lines over the first fill: exact along a line, an error of about 1e-3 of the area across."""


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


def overlap(rings: Sequence[Array], others: Sequence[Array]) -> Overlap:
    """Area of the even-odd fill of `rings`, and of its part inside that of `others`; (m, 2), mm."""
    y = np.concatenate([ring[:, 1] for ring in rings])
    bottom, height = float(y.min()), float(np.ptp(y)) / _LINES
    lines = np.asarray(bottom + (np.arange(_LINES) + 0.5) * height, dtype=np.float64)
    row_a, x_a = _ends(rings, lines)
    row_b, x_b = _ends(others, lines)
    rows, x = np.concatenate([row_a, row_b]), np.concatenate([x_a, x_b])
    order = np.lexsort((x, rows))
    first = order < len(row_a)
    # Every line crosses a ring an even number of times, so the parities may run on over the lines.
    in_a = np.cumsum(first) % 2 == 1
    in_b = np.cumsum(~first) % 2 == 1
    steps = widths(x[order])
    return Overlap(
        area_mm2=float(steps[in_a].sum()) * height,
        shared_mm2=float(steps[in_a & in_b].sum()) * height,
    )


def area_mm2(rings: Sequence[Array]) -> float:
    """Area of the even-odd fill of `rings`, each (m, 2), mm."""
    return overlap(rings, ()).area_mm2


def _ends(rings: Sequence[Array], lines: Array) -> tuple[NDArray[np.intp], Array]:
    if not rings:
        return np.empty(0, dtype=np.intp), np.empty(0)
    blocks = list(crossings(rings, lines))
    return np.concatenate([rows for rows, _ in blocks]), np.concatenate([x for _, x in blocks])
