"""What follows from all frames of a cycle together."""

from collections.abc import Mapping, Sequence
from dataclasses import dataclass

import numpy as np

from schemas.cycle_report import ChamberCycleReport, CycleReport, LeftVentricleCycleReport
from schemas.frame_report import FrameReport
from schemas.vocabulary import Structure
from worker.artifacts.cycle_surface import surface_cycle
from worker.artifacts.end_diastole import Series, end_diastole, volumes_ml
from worker.artifacts.measured import MeasuredFrame
from worker.evaluation.change import change_percent, shortening_percent
from worker.evaluation.function import shrinkage_percent
from worker.evaluation.jitter import jitter
from worker.evaluation.volume_curve import FEWEST_FRAMES, peak_rates, period_ms
from worker.reconstruction.cycle import in_time
from worker.tracking.tracked_surface import NOT_OBSERVED, TrackedSurface

_CHAMBERS = (Structure.LV_ENDO, Structure.RV_ENDO)


@dataclass(frozen=True)
class _Clock:
    """times_ms: None where a frame has none. period_ms: None where frames are no whole cycle, or
    their times do not grow.
    """

    times_ms: list[float] | None
    period_ms: float | None
    is_whole_cycle: bool


def cycle_report(
    measured: Sequence[tuple[FrameReport, MeasuredFrame]],
    tracked: Mapping[Structure, TrackedSurface],
    *,
    is_whole_cycle: bool,
) -> CycleReport | None:
    """Of three frames or more, put in order of time; None of fewer. tracked: surfaces that were
    carried through frames of these labels.
    """
    if len(measured) < FEWEST_FRAMES:
        return None
    ordered = [measured[i] for i in in_time([report.time_ms for report, _ in measured])]
    frames = [report for report, _ in ordered]
    clock = _clock(frames, is_whole_cycle=is_whole_cycle)
    since = end_diastole(frames)
    structures = dict.fromkeys(structure for frame in frames for structure in frame.surfaces)
    chambers = {s: _chamber(frames, s, clock) for s in _CHAMBERS if s in structures}
    return CycleReport(
        frames=[frame.label for frame in frames],
        times_ms=clock.times_ms,
        is_whole_cycle=is_whole_cycle,
        period_ms=clock.period_ms,
        ed_frame=frames[since].label,
        chambers={structure: one for structure, one in chambers.items() if one},
        surfaces={
            structure: surface_cycle(ordered, structure, since, tracked.get(structure))
            for structure in structures
        },
        left_ventricle=_left_ventricle(frames, since),
        not_observed=NOT_OBSERVED if tracked else None,
    )


def _clock(frames: Sequence[FrameReport], *, is_whole_cycle: bool) -> _Clock:
    times = [frame.time_ms for frame in frames if frame.time_ms is not None]
    if len(times) < len(frames):
        return _Clock(None, None, is_whole_cycle)
    lasts = is_whole_cycle and bool((np.diff(times) > 0.0).all())
    return _Clock(times, period_ms(np.array(times)) if lasts else None, is_whole_cycle)


def _chamber(
    frames: Sequence[FrameReport], structure: Structure, clock: _Clock
) -> ChamberCycleReport | None:
    series = volumes_ml(frames, structure)
    having = [i for i, volume in enumerate(series) if volume]
    if len(having) < FEWEST_FRAMES:
        return None
    volumes = np.array([series[i] for i in having], dtype=np.float64)
    largest, smallest = int(volumes.argmax()), int(volumes.argmin())
    edv_ml, esv_ml = float(volumes[largest]), float(volumes[smallest])
    rates = None
    if clock.times_ms is not None:
        times_ms = np.array([clock.times_ms[i] for i in having])
        rates = peak_rates(volumes, times_ms, clock.period_ms)
    return ChamberCycleReport(
        ed_frame=frames[having[largest]].label,
        es_frame=frames[having[smallest]].label,
        edv_ml=edv_ml,
        esv_ml=esv_ml,
        stroke_volume_ml=edv_ml - esv_ml,
        ejection_fraction_percent=shrinkage_percent(edv_ml, esv_ml),
        peak_ejection_rate_ml_per_s=rates.ejection_ml_per_s if rates else None,
        peak_filling_rate_ml_per_s=rates.filling_ml_per_s if rates else None,
        jitter_ml=jitter(series, is_whole_cycle=clock.is_whole_cycle),
    )


def _left_ventricle(frames: Sequence[FrameReport], since: int) -> LeftVentricleCycleReport:
    left = [frame.left_ventricle for frame in frames]
    walls = [one.wall_thickness_mm or {} for one in left]
    thickness: dict[int, Series] = {
        number: [wall[number].mean_mm if number in wall else None for wall in walls]
        for number in sorted({number for wall in walls for number in wall})
    }
    return LeftVentricleCycleReport(
        longitudinal_shortening_percent=shortening_percent(
            [one.long_axis_length_mm for one in left], since
        ),
        circumferential_shortening_percent=shortening_percent(
            [one.mid_perimeter_mm for one in left], since
        ),
        wall_mass_g=[one.wall_mass_g for one in left],
        wall_thickness_mm=thickness,
        wall_thickening_percent={
            number: change_percent(series, since) for number, series in thickness.items()
        },
    )
