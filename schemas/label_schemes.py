"""The published label schemes: which value is which tissue, view by view."""

from schemas.labels import LabelScheme, TissueLabels
from schemas.vocabulary import View

_MNMS = TissueLabels(lv_cavity=[1], lv_wall=[2], rv_cavity=[3])

_SHORT_AXIS: dict[LabelScheme, TissueLabels] = {
    LabelScheme.ACDC: TissueLabels(rv_cavity=[1], lv_wall=[2], lv_cavity=[3]),
    LabelScheme.MNMS: _MNMS,
    LabelScheme.UKBB: _MNMS,
    LabelScheme.DIGITAL_HEART: TissueLabels(lv_cavity=[1], lv_wall=[2], rv_cavity=[4]),
    LabelScheme.BIV_ME: TissueLabels(lv_cavity=[1], lv_wall=[2], rv_cavity=[3], rv_wall=[4]),
    LabelScheme.MMWHS_7: TissueLabels(
        lv_wall=[1], lv_cavity=[3], rv_cavity=[5], ignored=[2, 4, 6, 7]
    ),
}

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
    return _LONG_AXIS.get((scheme, view), _SHORT_AXIS[scheme])
