"""Pump function of a subject, from the volumes and areas of its frames."""

from collections.abc import Sequence

from schemas.frame_report import FrameReport
from schemas.report import FunctionReport
from schemas.vocabulary import Structure
from worker.evaluation.function import lv_function, shrinkage_percent


def function_report(frames: Sequence[FrameReport]) -> FunctionReport | None:
    """Pump function, where end-diastole and end-systole both have a closed left endocardium."""
    by_label = {frame.label.upper(): frame for frame in frames}
    if not {"ED", "ES"} <= by_label.keys():
        return None
    ed, es = by_label["ED"], by_label["ES"]
    left = _volumes_ml(ed, es, Structure.LV_ENDO)
    if left is None:
        return None
    found = lv_function(*left).model_dump()
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


def _volumes_ml(
    ed: FrameReport, es: FrameReport, structure: Structure
) -> tuple[float, float] | None:
    """At end-diastole and end-systole, where both frames have the surface closed."""
    both = [f.surfaces[structure].volume_ml for f in (ed, es) if structure in f.surfaces]
    return (both[0], both[1]) if len(both) == 2 and both[0] and both[1] else None
