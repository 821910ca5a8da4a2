"""The pieces of an outline on one slice, made one contour."""

from collections.abc import Sequence
from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

from intake.crossing_edges import crossing_edges
from intake.formats.outline_joining import Joined, join
from intake.formats.outline_path import LONG_STEP, typical_step
from intake.formats.outline_runs import Runs, distinct
from intake.simplicity import CROSSED_SHARE, shoelace_mm2

Array = NDArray[np.float64]

_CLOSED_SHARE = 0.15
"""Opening over length up to which a short-axis outline is closed over a gap: where two pieces meet,
a few points are often missing. Where more is, a chord would cut off what is inside: at the base the
wall is a crescent about the aorta."""

_OPEN_SHARE = 0.45
"""Opening over length beyond which a chord across it would cut through the structure."""

_COMPLETES = 0.7
"""How much smaller the septum has to make the share that is open, to be what is missing there."""

_MOST_RUNS = 12
"""Pieces beyond which points are no outline."""

_END = 0.25
"""Share of a piece, from either end, in which it may run past the septum's end."""


@dataclass(frozen=True, eq=False)
class WholeOutline:
    """A contour (n, 2) in its plane, told from any point, and what was mended.

    flaw: why it is none after all.
    """

    points: Array
    closed: bool
    spikes: int
    flaw: str | None


def whole_outline(
    wall: Sequence[Runs], septum: Runs | None, *, long_axis: bool, valve: Array | None
) -> WholeOutline:
    """One outline from pieces in one plane.

    Args:
        wall: the structure's own pieces, at least one.
        septum: what completes it where the wall alone leaves it open.
        long_axis: the outline may be open at a valve; else it is closed.
        valve: points (k, 2) of the valve that it is open at.
    """
    runs = [run for one in wall for run in one.runs]
    spikes = sum(one.spikes for one in wall)
    if len(runs) > _MOST_RUNS:
        return WholeOutline(runs[0], False, spikes, f"is in {len(runs)} pieces")
    joined = join(runs, valve)
    if septum is not None and len(septum.runs) <= _MOST_RUNS and not _is_ring(joined):
        ends = np.concatenate([run[[0, -1]] for run in septum.runs])
        completed = join([*(_trimmed(run, ends) for run in runs), *septum.runs], valve)
        if _open_share(completed) < _COMPLETES * _open_share(joined):
            joined, spikes = completed, spikes + septum.spikes
    return _judged(joined, spikes, long_axis)


def _judged(joined: Joined, spikes: int, long_axis: bool) -> WholeOutline:
    share = _open_share(joined)
    points = distinct(joined.points)  # pieces may share their ends
    closed = _is_ring(joined) or not long_axis
    flaw = None
    if len(points) < 3:
        flaw = "has fewer than three points"
    elif share > (_OPEN_SHARE if long_axis else _CLOSED_SHARE):
        flaw = f"lacks a stretch as long as {100 * share:.0f} % of what is there"
    elif _is_tangled(points, closed):
        flaw = "crosses itself"
    return WholeOutline(points, closed, spikes, flaw)


def _is_tangled(ring: Array, closed: bool) -> bool:
    """Whether it crosses itself by more than the slip of a pen."""
    (found,) = crossing_edges([(ring, closed)])
    if found is None:
        return True
    area = abs(shoelace_mm2(ring))
    loops = [abs(shoelace_mm2(ring[i + 1 : j + 1])) for i, j in zip(*found, strict=True)]
    return any(min(loop, abs(area - loop)) > CROSSED_SHARE * area for loop in loops)


def _open_share(joined: Joined) -> float:
    return max(joined.opening, joined.longest_joint) / max(joined.length, 1e-9)


def _trimmed(run: Array, ends: Array) -> Array:
    """The run (n, 2) without what hooks past the nearest of the septum's ends (k, 2)."""
    untouched = 0
    while untouched < 2:
        run = run[::-1]
        last = run[-max(1, int(_END * len(run))) :]
        distances = np.linalg.norm(last[:, None, :] - ends[None, :, :], axis=2)
        nearest = distances[:, int(np.argmin(distances[-1]))]
        beyond = len(last) - 1 - int(np.argmin(nearest))
        run = run[: len(run) - beyond]
        untouched = 0 if beyond else untouched + 1
    return run


def _is_ring(joined: Joined) -> bool:
    if len(joined.points) < 3:
        return False
    return joined.opening <= LONG_STEP * typical_step(joined.points)
