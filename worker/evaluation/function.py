"""What the left ventricle pumps."""

from schemas.report import FunctionReport


def lv_function(edv_ml: float, esv_ml: float) -> FunctionReport:
    """Stroke volume (mL) and ejection fraction (%) from end-diastolic and end-systolic volume.

    edv_ml must be positive.
    """
    stroke_ml = edv_ml - esv_ml
    return FunctionReport(
        lv_edv_ml=edv_ml,
        lv_esv_ml=esv_ml,
        lv_stroke_volume_ml=stroke_ml,
        lv_ejection_fraction_percent=100.0 * stroke_ml / edv_ml,
    )
