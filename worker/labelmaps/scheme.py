"""Which label value is which tissue: the published schemes, and an explicit one."""

from enum import IntEnum

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

_MNMS = TissueLabels(lv_cavity=[1], lv_wall=[2], rv_cavity=[3])

PUBLISHED: dict[LabelScheme, TissueLabels] = {
    LabelScheme.ACDC: TissueLabels(rv_cavity=[1], lv_wall=[2], lv_cavity=[3]),
    LabelScheme.MNMS: _MNMS,
    LabelScheme.UKBB: _MNMS,
    LabelScheme.DIGITAL_HEART: TissueLabels(lv_cavity=[1], lv_wall=[2], rv_cavity=[4]),
    LabelScheme.BIV_ME: TissueLabels(lv_cavity=[1], lv_wall=[2], rv_cavity=[3], rv_wall=[4]),
    LabelScheme.MMWHS_7: TissueLabels(
        lv_wall=[1], lv_cavity=[3], rv_cavity=[5], ignored=[2, 4, 6, 7]
    ),
}
"""The schemes as their short-axis maps have them."""

# biv-me numbers each view on its own: src/bivme/preprocessing/dicom/src/contouring.py, Apache-2.0.
_BIV_ME_ATRIA_AND_VESSELS = TissueLabels(
    lv_cavity=[1], lv_wall=[2], rv_cavity=[3], rv_wall=[6], ignored=[4, 5]
)
# ukbb_cardiac's four-chamber maps carry the atria too. Its atrial maps (LA 1, RA 2) reuse the
# values of the ventricles, and are no input; the check of the anatomy refuses them.
_UKBB_ATRIA = _MNMS.model_copy(update={"ignored": [4, 5]})
_LONG_AXIS: dict[tuple[LabelScheme, View], TissueLabels] = {
    (LabelScheme.UKBB, View.LAX_2CH): _UKBB_ATRIA,
    (LabelScheme.UKBB, View.LAX_3CH): _UKBB_ATRIA,
    (LabelScheme.UKBB, View.LAX_4CH): _UKBB_ATRIA,
    (LabelScheme.BIV_ME, View.LAX_2CH): TissueLabels(lv_cavity=[1], lv_wall=[2], ignored=[3]),
    (LabelScheme.BIV_ME, View.LAX_3CH): _BIV_ME_ATRIA_AND_VESSELS,
    (LabelScheme.BIV_ME, View.LAX_4CH): _BIV_ME_ATRIA_AND_VESSELS,
}


def published_labels(scheme: LabelScheme, view: View) -> TissueLabels:
    """The label values of a published scheme in a view's maps."""
    return _LONG_AXIS.get((scheme, view), PUBLISHED[scheme])


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
