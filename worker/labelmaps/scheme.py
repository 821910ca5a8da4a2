"""Which label value is which tissue, and which tissues a structure encloses."""

from enum import IntEnum

from schemas.label_schemes import published_labels
from schemas.labels import LabelRequest, LabelScheme, TissueLabels
from schemas.vocabulary import Structure, View


class Tissue(IntEnum):
    """A voxel's tissue, whatever the scheme called it."""

    BACKGROUND = 0
    LV_CAVITY = 1
    LV_WALL = 2
    RV_CAVITY = 3
    RV_WALL = 4


STRUCTURE_TISSUES: dict[Structure, tuple[Tissue, ...]] = {
    Structure.LV_ENDO: (Tissue.LV_CAVITY,),
    Structure.LV_EPI: (Tissue.LV_CAVITY, Tissue.LV_WALL),
    Structure.RV_ENDO: (Tissue.RV_CAVITY,),
    Structure.RV_EPI: (Tissue.RV_CAVITY, Tissue.RV_WALL),
}
"""What each outlined structure encloses. The last tissue must be labelled for it to be known."""


def tissue_labels(request: LabelRequest, view: View) -> TissueLabels:
    """The label values that a request declares for a view's map."""
    if isinstance(request.label_scheme, LabelScheme):
        return published_labels(request.label_scheme, view)
    return request.label_scheme


def values_by_tissue(labels: TissueLabels) -> dict[Tissue, list[int]]:
    """The label values of each tissue; values to ignore are background."""
    return {
        Tissue.LV_CAVITY: labels.lv_cavity,
        Tissue.LV_WALL: labels.lv_wall,
        Tissue.RV_CAVITY: labels.rv_cavity,
        Tissue.RV_WALL: labels.rv_wall,
    }
