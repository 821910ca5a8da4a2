"""Points evenly along an outline, whether it is closed or open."""

import numpy as np

from worker.arrays import PlanePoints

_LEAST = 8
"""Fewer points would lose the shape of a small outline."""


def evenly_along(points_mm: PlanePoints, spacing_mm: float, *, closed: bool) -> np.ndarray:
    """Points at most `spacing_mm` apart along a polyline (n, 2), on it; (k, 2) with k >= 8.

    A closed one is joined from its last point to its first; an open one keeps both its ends.
    """
    length = _length_to(points_mm, closed=closed)[-1]
    return at_fractions(points_mm, max(_LEAST, int(np.ceil(length / spacing_mm))), closed=closed)


def at_fractions(points_mm: PlanePoints, count: int, *, closed: bool) -> np.ndarray:
    """`count` points at equal lengths along a polyline (n, 2), from its first point on."""
    length = _length_to(points_mm, closed=closed)
    path = np.vstack([points_mm, points_mm[:1]]) if closed else points_mm
    at = np.linspace(0.0, length[-1], count, endpoint=not closed)
    return np.column_stack([np.interp(at, length, path[:, axis]) for axis in (0, 1)])


def _length_to(points_mm: PlanePoints, *, closed: bool) -> np.ndarray:
    path = np.vstack([points_mm, points_mm[:1]]) if closed else points_mm
    return np.concatenate([[0.0], np.linalg.norm(np.diff(path, axis=0), axis=1).cumsum()])
