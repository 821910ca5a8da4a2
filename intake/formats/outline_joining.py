"""Runs of points joined into one outline, and where it is open."""

from collections.abc import Sequence
from dataclasses import dataclass
from itertools import pairwise, permutations, product

import numpy as np
from numpy.typing import NDArray

Array = NDArray[np.float64]

_EXHAUSTIVE = 5
"""Runs up to which every way of joining them is looked at: 4! orders, 2^4 directions."""


@dataclass(frozen=True, eq=False)
class Joined:
    """An outline (n, 2) from its opening to its opening.

    opening: length of the step from its last point to its first. longest_joint: the longest of the
    other steps between two runs. length: of the runs alone.
    """

    points: Array
    opening: float
    length: float
    longest_joint: float


def join(runs: Sequence[Array], open_at: Array | None = None) -> Joined:
    """The runs in the order and directions that make the shortest closed way.

    It is opened at its longest joint; or, where points `open_at` (k, 2) mark an opening, at the
    joint that is nearest to them, unless that is the shorter one by far.
    """
    order = _shortest(runs)
    ends = [(order[k - 1][-1], order[k][0]) for k in range(len(order))]
    lengths = np.array([float(np.linalg.norm(b - a)) for a, b in ends])
    at = int(np.argmax(lengths))
    if open_at is not None and len(open_at) and len(order) > 1:
        middles = np.array([0.5 * (a + b) for a, b in ends])
        marked = int(np.argmin(np.linalg.norm(middles - open_at.mean(axis=0), axis=1)))
        if lengths[marked] > 0.5 * lengths[at]:
            at = marked
    points = np.concatenate(order[at:] + order[:at])
    steps = [np.linalg.norm(np.diff(run, axis=0), axis=1).sum() for run in order]
    others = np.delete(lengths, at)
    return Joined(
        points,
        float(lengths[at]),
        float(sum(steps)),
        float(others.max()) if len(others) else 0.0,
    )


def _shortest(runs: Sequence[Array]) -> list[Array]:
    if len(runs) == 1:
        return list(runs)
    if len(runs) <= _EXHAUSTIVE:
        # Of run k, end 2k comes first as it is told, end 2k + 1 last.
        ends = np.concatenate([run[[0, -1]] for run in runs])
        apart = np.linalg.norm(ends[:, None] - ends[None, :], axis=2).tolist()
        ways = (
            [0, *(2 * i + turn for i, turn in zip(order, turns, strict=True))]
            for order in permutations(range(1, len(runs)))
            for turns in product((0, 1), repeat=len(runs) - 1)
        )
        best = min(ways, key=lambda way: _joints(way, apart))
        return [runs[one // 2][:: -1 if one % 2 else 1] for one in best]
    left = list(runs)
    way = [left.pop(int(np.argmax([len(run) for run in left])))]
    while left:
        here = way[-1][-1]
        near = [
            (float(np.linalg.norm(run[end] - here)), i, end)
            for i, run in enumerate(left)
            for end in (0, -1)
        ]
        _, i, end = min(near)
        run = left.pop(i)
        way.append(run if end == 0 else run[::-1])
    return way


def _joints(way: Sequence[int], apart: Sequence[Sequence[float]]) -> float:
    """Length of all joints of runs that are entered at these ends, the way closed."""
    return sum(apart[one ^ 1][other] for one, other in pairwise([*way, way[0]]))
