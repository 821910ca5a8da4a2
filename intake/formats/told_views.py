"""Views of guide-point slices, told by what was marked on them."""

from collections.abc import Collection

from intake.formats.guide_point_types import view_and_kind
from schemas.vocabulary import View


def told_view(contour_types: Collection[str]) -> tuple[View, bool]:
    """The view of a slice by all contour types that any frame has there, and whether it is sure.

    A long-axis slice through the aortic valve is the three-chamber view, one through the tricuspid
    valve the four-chamber view; one without a right ventricle the two-chamber view. What shows the
    right ventricle alone (the outflow tract, a right two-chamber view) is `other`.
    """
    kinds = {view_and_kind(one) for one in contour_types}
    if any(view == "SAX" for view, _ in kinds):
        return View.SAX, True
    names = {kind for _, kind in kinds}
    left = any(kind.startswith("LV_") for kind in names)
    right = any(kind.startswith("RV_") and kind != "RV_INSERT" for kind in names)
    if not left:
        return View.OTHER, True
    if "AORTA_VALVE" in names:
        return View.LAX_3CH, True
    if "TRICUSPID_VALVE" in names:
        return View.LAX_4CH, True
    if not right:
        return View.LAX_2CH, True
    return View.OTHER, False
