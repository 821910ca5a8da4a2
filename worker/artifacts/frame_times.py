"""When the frames of a report are: in their order in time, and as seconds for a player."""

from collections.abc import Sequence
from dataclasses import dataclass
from itertools import pairwise

import numpy as np

from schemas.cycle_report import Series
from schemas.frame_report import FrameReport, StudyFrame
from schemas.report import Report
from worker.evaluation.volume_curve import period_ms
from worker.reconstruction.cycle import in_time

_WITHOUT_TIMES_S = 1.0
"""How long a cycle plays of which no times are known."""

_LONG = 1.5
"""Median steps; where a step is longer, a frame is missing that the study never had."""


@dataclass(frozen=True)
class FrameTimes:
    """The clock of all frames that have results.

    labels: in the order of time. places: of each among the frames of the study, from 0 on, with one
    to spare in every step that is too long; `count` of them all. times_ms: None unless every frame
    of the study has one of its own. is_whole_cycle: whether the study's first frame comes after its
    last one again. step_ms: the study's median one. period_ms: of a whole cycle, by the study's
    frames; None where times are not known.
    """

    labels: tuple[str, ...]
    places: tuple[int, ...]
    count: int
    times_ms: tuple[float, ...] | None
    is_whole_cycle: bool
    step_ms: float | None
    period_ms: float | None

    @property
    def unit(self) -> str:
        """Of `steps`."""
        return "frame index" if self.times_ms is None else "ms"

    @property
    def steps(self) -> tuple[float, ...]:
        """Of each frame: its time in ms, or where those are not known its place in the study."""
        return tuple(map(float, self.places)) if self.times_ms is None else self.times_ms

    @property
    def period_s(self) -> float:
        """How long they play: a whole cycle its period, others to one step after the last frame;
        1 s without times.
        """
        if self.times_ms is None or self.step_ms is None:
            return _WITHOUT_TIMES_S
        lasts_ms = self.period_ms or self.times_ms[-1] - self.times_ms[0] + self.step_ms
        return lasts_ms / 1000.0

    @property
    def seconds(self) -> tuple[float, ...]:
        """From the first frame on, evenly over the period where times are not known."""
        if self.times_ms is None:
            since = self.places[0]
            return tuple((p - since) / self.count * self.period_s for p in self.places)
        return tuple((time - self.times_ms[0]) / 1000.0 for time in self.times_ms)

    def by_place(self, series: Series) -> Series:
        """Numbers of the frames at their places, None at all others: so neighbours are a step apart
        in time.
        """
        found = dict(zip(self.places, series, strict=True))
        return [found.get(place) for place in range(self.count)]


def frame_times(
    frames: Sequence[FrameReport], study: Sequence[StudyFrame] = (), *, is_whole_cycle: bool
) -> FrameTimes:
    """Of a report's frames. Where two of the study are at one time, times are taken as not known.

    study: all its frames in its order; the report's alone where none are given.
    """
    everyone = study or [StudyFrame(label=one.label, time_ms=one.time_ms) for one in frames]
    order = [everyone[place] for place in in_time([one.time_ms for one in everyone])]
    known = [one.time_ms for one in order if one.time_ms is not None]
    is_known = len(known) == len(order) and all(a < b for a, b in pairwise(known))
    steps_ms = np.diff(known) if is_known and len(known) > 1 else None
    leaps = np.zeros(len(order), dtype=np.int64)
    if steps_ms is not None:
        leaps[1:] = np.cumsum(steps_ms > _LONG * np.median(steps_ms))
    having = {frame.label for frame in frames}
    there = [index for index, one in enumerate(order) if one.label in having]
    lasts = is_whole_cycle and steps_ms is not None
    return FrameTimes(
        labels=tuple(order[index].label for index in there),
        places=tuple(index + int(leaps[index]) for index in there),
        count=len(order) + int(leaps.max(initial=0)),
        times_ms=tuple(known[index] for index in there) if is_known else None,
        is_whole_cycle=is_whole_cycle,
        step_ms=None if steps_ms is None else float(np.median(steps_ms)),
        period_ms=period_ms(np.array(known)) if lasts else None,
    )


def report_times(report: Report) -> FrameTimes:
    """Of a report. What is left of a cycle that was stopped early is no whole one."""
    whole = report.options.sequence.whole_cycle and not report.stopped_early
    return frame_times(report.frames, report.study_frames, is_whole_cycle=whole)
