"""When the frames of a report are: in their order in time, and as seconds for a player."""

from collections.abc import Sequence
from dataclasses import dataclass
from itertools import pairwise

import numpy as np

from schemas.frame_report import FrameReport
from worker.reconstruction.cycle import in_time

_WITHOUT_TIMES_S = 1.0
"""How long a cycle plays of which no times are known."""


@dataclass(frozen=True)
class FrameTimes:
    """labels: in the order of time. times_ms: None unless every frame has one of its own.
    is_whole_cycle: whether the first frame comes after the last one again.
    """

    labels: tuple[str, ...]
    times_ms: tuple[float, ...] | None
    is_whole_cycle: bool

    @property
    def unit(self) -> str:
        """Of `steps`."""
        return "frame index" if self.times_ms is None else "ms"

    @property
    def steps(self) -> tuple[float, ...]:
        """Of each frame: its time in ms, or where those are not known its place from 0 on."""
        places = tuple(float(place) for place in range(len(self.labels)))
        return places if self.times_ms is None else self.times_ms

    @property
    def period_s(self) -> float:
        """How long they play: to one median step after the last frame; 1 s without times."""
        if self.times_ms is None or len(self.times_ms) < 2:
            return _WITHOUT_TIMES_S
        step_ms = float(np.median(np.diff(self.times_ms)))
        return (self.times_ms[-1] - self.times_ms[0] + step_ms) / 1000.0

    @property
    def seconds(self) -> tuple[float, ...]:
        """From the first frame on, evenly over the period where times are not known."""
        if self.times_ms is None:
            return tuple(place / len(self.labels) * self.period_s for place in self.steps)
        return tuple((time - self.times_ms[0]) / 1000.0 for time in self.times_ms)


def frame_times(frames: Sequence[FrameReport], *, is_whole_cycle: bool) -> FrameTimes:
    """Of a report's frames. Where two are at one time, times are taken as not known."""
    order = [frames[place] for place in in_time([frame.time_ms for frame in frames])]
    known = tuple(frame.time_ms for frame in order if frame.time_ms is not None)
    rising = all(before < after for before, after in pairwise(known))
    times = known if rising and len(known) == len(order) else None
    return FrameTimes(tuple(frame.label for frame in order), times, is_whole_cycle)
