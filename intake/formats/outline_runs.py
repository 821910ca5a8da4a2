"""Pieces of an outline without gaps."""

from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

from intake.formats.outline_path import LONG_STEP, in_order, typical_step

Array = NDArray[np.float64]

_SPIKE = 4.0
"""How much longer than the way past it the way over a point is, for it to be a slip."""


@dataclass(frozen=True, eq=False)
class Runs:
    """Runs (n, 2) of points in order, each without a gap; and how many spikes were left out."""

    runs: tuple[Array, ...]
    spikes: int


def runs_of(points: Array) -> Runs:
    """The runs in the points (n, 2) of one kind on one slice, whatever their order.

    A run whose ends are neighbours is a ring; it is cut at its longest step all the same.
    """
    own = distinct(points)
    if len(own) < 2:
        return Runs((own,) if len(own) else (), 0)
    path = own[in_order(own)]
    kept = _without_spikes(path)
    spikes = len(path) - len(kept)
    gap = LONG_STEP * typical_step(kept)
    steps = np.linalg.norm(np.diff(kept, axis=0), axis=1)
    runs = np.split(kept, np.flatnonzero(steps > gap) + 1)
    # A piece may be told from its middle to one end, and on from the other.
    if len(runs) > 1 and np.linalg.norm(kept[0] - kept[-1]) <= gap:
        runs = [np.concatenate([runs[-1], runs[0]]), *runs[1:-1]]
    return Runs(tuple(runs), spikes)


def distinct(points: Array) -> Array:
    """Without repeats of a point, wherever they stand; the first of each is kept."""
    _, first = np.unique(points.round(6), axis=0, return_index=True)
    return points[np.sort(first)]


def _without_spikes(path: Array) -> Array:
    """Without single points far off the line of their neighbours."""
    if len(path) < 5:
        return path
    before, here, after = path[:-2], path[1:-1], path[2:]
    past = np.linalg.norm(after - before, axis=1)
    there = np.linalg.norm(here - before, axis=1)
    back = np.linalg.norm(after - here, axis=1)
    long = LONG_STEP * typical_step(path)
    spike = (np.minimum(there, back) > long) & (there + back > _SPIKE * past)
    return path[np.concatenate([[True], ~spike, [True]])]
