"""What a ventricle pumps."""

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
        lv_ejection_fraction_percent=shrinkage_percent(edv_ml, esv_ml),
    )


def shrinkage_percent(diastolic: float, systolic: float) -> float:
    """How much of a positive diastolic measure is gone at end-systole, %: of volumes the ejection
    fraction, of areas the fractional area change.
    """
    return 100.0 * (diastolic - systolic) / diastolic
