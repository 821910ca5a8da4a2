"""Pump function of a subject, from the volumes and areas of its frames."""

from collections.abc import Sequence

from schemas.frame_report import FrameReport
from schemas.report import FunctionReport
from schemas.vocabulary import Structure
from worker.evaluation.function import lv_function, shrinkage_percent

_FEWEST_FRAMES = 3
"""With the left cavity closed, of which the largest and the smallest are taken."""


def function_report(frames: Sequence[FrameReport]) -> FunctionReport | None:
    """Pump function, where end-diastole and end-systole both have a closed left endocardium.

    They are the frames of these names (ED, ES) where there are both, whatever their volumes. Else,
    where three frames or more have it closed, those of its largest and its smallest volume.
    """
    instants = _by_name(frames) or _by_volume(frames)
    if instants is None:
        return None
    ed, es = instants
    left = _volumes_ml(ed, es, Structure.LV_ENDO)
    if left is None:
        return None
    found = lv_function(*left).model_dump() | {"ed_frame": ed.label, "es_frame": es.label}
    areas = ed.left_ventricle.mid_area_cm2, es.left_ventricle.mid_area_cm2
    if areas[0] and areas[1] is not None:
        found["lv_fractional_area_change_percent"] = shrinkage_percent(areas[0], areas[1])
    right = _volumes_ml(ed, es, Structure.RV_ENDO)
    if right is not None:
        found |= {
            "rv_edv_ml": right[0],
            "rv_esv_ml": right[1],
            "rv_stroke_volume_ml": right[0] - right[1],
            "rv_ejection_fraction_percent": shrinkage_percent(*right),
        }
    return FunctionReport.model_validate(found)


def _by_name(frames: Sequence[FrameReport]) -> tuple[FrameReport, FrameReport] | None:
    by_label = {frame.label.upper(): frame for frame in frames}
    return (by_label["ED"], by_label["ES"]) if {"ED", "ES"} <= by_label.keys() else None


def _by_volume(frames: Sequence[FrameReport]) -> tuple[FrameReport, FrameReport] | None:
    volumes_ml = [(_volume_ml(frame, Structure.LV_ENDO), frame) for frame in frames]
    closed = [(volume, frame) for volume, frame in volumes_ml if volume]
    if len(closed) < _FEWEST_FRAMES:
        return None
    _, ed = max(closed, key=lambda one: one[0])
    _, es = min(closed, key=lambda one: one[0])
    return ed, es


def _volumes_ml(
    ed: FrameReport, es: FrameReport, structure: Structure
) -> tuple[float, float] | None:
    """At end-diastole and end-systole, where both frames have the surface closed."""
    diastolic, systolic = _volume_ml(ed, structure), _volume_ml(es, structure)
    return (diastolic, systolic) if diastolic and systolic else None


def _volume_ml(frame: FrameReport, structure: Structure) -> float | None:
    return frame.surfaces[structure].volume_ml if structure in frame.surfaces else None
