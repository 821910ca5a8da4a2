"""The outlines of a study, measured all at once: each alone is too little work for a call."""

from collections.abc import Sequence
from dataclasses import dataclass, replace

import numpy as np
from numpy.typing import NDArray

from intake.crossing_edges import Found, crossing_edges
from intake.overlap import overlaps
from intake.placed import PlacedContour, PlacedSlice

Array = NDArray[np.float64]

LEAST_POINTS = 3
"""Of a ring that can enclose anything."""


@dataclass(frozen=True, eq=False)
class Outline:
    """A contour without repeats of a point by its neighbour, and what is measured of it.

    ring: (n, 2), mm; of fewer than three points nothing is measured. index: (n,) where each stands
    among the points as sent. filled_mm2: its even-odd area. crossing: its edges that cross.
    """

    contour: PlacedContour
    ring: Array
    index: NDArray[np.intp]
    filled_mm2: float = 0.0
    crossing: Found = None


def measured_outlines(slices: Sequence[PlacedSlice]) -> list[list[Outline]]:
    """The outlines of each slice."""
    distinct = [[Outline(c, *_distinct(c)) for c in slice_.contours] for slice_ in slices]
    whole = [one for outlines in distinct for one in outlines if len(one.ring) >= LEAST_POINTS]
    areas = iter(overlaps([([one.ring], ()) for one in whole]))
    crossings = iter(crossing_edges([(one.ring, one.contour.closed) for one in whole]))

    def measured(one: Outline) -> Outline:
        if len(one.ring) < LEAST_POINTS:
            return one
        return replace(one, filled_mm2=next(areas).area_mm2, crossing=next(crossings))

    return [[measured(one) for one in outlines] for outlines in distinct]


def _distinct(contour: PlacedContour) -> tuple[Array, NDArray[np.intp]]:
    """The ring without repeats of a point by its neighbour, and each point's index as sent."""
    ring = contour.ring
    near = 1e-9 * (np.ptp(ring, axis=0).max() + np.abs(ring).max())
    moved = np.abs(np.diff(ring, axis=0)).max(axis=1) > near
    index = np.concatenate([[0], 1 + np.flatnonzero(moved)])
    if contour.closed and len(index) > 1 and np.abs(ring[index[-1]] - ring[0]).max() <= near:
        index = index[:-1]
    return ring[index], index
