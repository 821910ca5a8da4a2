"""What follows from all frames of a cycle together."""

from collections.abc import Mapping, Sequence

import numpy as np

from schemas.cycle_report import (
    FEWEST_FRAMES,
    ChamberCycleReport,
    CycleReport,
    LeftVentricleCycleReport,
    Series,
)
from schemas.frame_report import FrameReport
from schemas.vocabulary import Structure
from worker.artifacts.cycle_surface import surface_cycle
from worker.artifacts.end_diastole import end_diastole
from worker.artifacts.frame_times import FrameTimes
from worker.artifacts.measured import MeasuredFrame
from worker.artifacts.surface_sizes import volumes_ml
from worker.evaluation.change import change_percent, shortening_percent
from worker.evaluation.extremes import largest_and_smallest
from worker.evaluation.function import shrinkage_percent
from worker.evaluation.jitter import jitter
from worker.evaluation.volume_curve import peak_rates
from worker.tracking.tracked_surface import NOT_OBSERVED, TrackedSurface

_CHAMBERS = (Structure.LV_ENDO, Structure.RV_ENDO)


def cycle_report(
    measured: Sequence[tuple[FrameReport, MeasuredFrame]],
    tracked: Mapping[Structure, TrackedSurface],
    times: FrameTimes,
    *,
    stopped_early: bool = False,
) -> CycleReport | None:
    """Of three frames or more, put in order of time; None of fewer. tracked: surfaces that were
    carried through frames of these labels. stopped_early: whether the smallest volumes may be among
    what is missing, so that no chamber is told of.
    """
    if len(measured) < FEWEST_FRAMES:
        return None
    by_label = {one[0].label: one for one in measured}
    ordered = [by_label[label] for label in times.labels]
    frames = [report for report, _ in ordered]
    since = end_diastole(frames)
    structures = dict.fromkeys(structure for frame in frames for structure in frame.surfaces)
    told = () if stopped_early else _CHAMBERS
    chambers = {s: _chamber(frames, s, times) for s in told if s in structures}
    return CycleReport(
        frames=[frame.label for frame in frames],
        times_ms=None if times.times_ms is None else list(times.times_ms),
        is_whole_cycle=times.is_whole_cycle,
        period_ms=times.period_ms,
        ed_frame=frames[since].label,
        chambers={structure: one for structure, one in chambers.items() if one},
        surfaces={
            structure: surface_cycle(ordered, structure, since, tracked.get(structure))
            for structure in structures
        },
        left_ventricle=_left_ventricle(frames, since),
        not_observed=NOT_OBSERVED if tracked else None,
    )


def _chamber(
    frames: Sequence[FrameReport], structure: Structure, times: FrameTimes
) -> ChamberCycleReport | None:
    series = volumes_ml(frames, structure)
    instants = largest_and_smallest(series)
    if instants is None:
        return None
    having = [i for i, volume in enumerate(series) if volume]
    volumes = np.array([series[i] for i in having], dtype=np.float64)
    edv_ml, esv_ml = float(volumes.max()), float(volumes.min())
    rates = None
    if times.times_ms is not None:
        times_ms = np.array([times.times_ms[i] for i in having])
        rates = peak_rates(volumes, times_ms, times.period_ms)
    return ChamberCycleReport(
        ed_frame=frames[instants[0]].label,
        es_frame=frames[instants[1]].label,
        edv_ml=edv_ml,
        esv_ml=esv_ml,
        stroke_volume_ml=edv_ml - esv_ml,
        ejection_fraction_percent=shrinkage_percent(edv_ml, esv_ml),
        peak_ejection_rate_ml_per_s=rates.ejection_ml_per_s if rates else None,
        peak_filling_rate_ml_per_s=rates.filling_ml_per_s if rates else None,
        jitter_ml=jitter(times.by_place(series), is_whole_cycle=times.is_whole_cycle),
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
