"""Pump function of a subject, from the volumes and areas of its frames."""

from collections.abc import Sequence

from schemas.frame_report import FrameReport
from schemas.report import FunctionReport
from schemas.vocabulary import Structure
from worker.artifacts.surface_sizes import volumes_ml
from worker.evaluation.extremes import largest_and_smallest
from worker.evaluation.function import lv_function, shrinkage_percent


def function_report(
    frames: Sequence[FrameReport], *, stopped_early: bool = False
) -> FunctionReport | None:
    """Pump function, where end-diastole and end-systole both have a closed left endocardium.

    They are the frames of these names (ED, ES) where there are both, whatever their volumes. Else,
    where three frames or more have it closed and none is missing because the job was stopped early,
    those of its largest and its smallest volume.
    """
    instants = _by_name(frames) or (None if stopped_early else _by_volume(frames))
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
    found = largest_and_smallest(volumes_ml(frames, Structure.LV_ENDO))
    return None if found is None else (frames[found[0]], frames[found[1]])


def _volumes_ml(
    ed: FrameReport, es: FrameReport, structure: Structure
) -> tuple[float, float] | None:
    """At end-diastole and end-systole, where both frames have the surface closed."""
    diastolic, systolic = volumes_ml([ed, es], structure)
    return (diastolic, systolic) if diastolic and systolic else None
