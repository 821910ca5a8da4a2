"""The label request: how to read uploaded NIfTI label maps."""

from collections import Counter
from enum import StrEnum
from typing import Self

from pydantic import Field, model_validator

from schemas.base import Name, WireModel
from schemas.options import Options


class LabelScheme(StrEnum):
    """A published convention of label values. Never guessed: ACDC and M&Ms swap 1 and 3."""

    ACDC = "acdc"
    MNMS = "mnms"
    UKBB = "ukbb"
    DIGITAL_HEART = "digital_heart"
    BIV_ME = "biv_me"
    MMWHS_7 = "mmwhs_7"


class Spacing(StrEnum):
    """Which part of a NIfTI header holds the voxel size when they disagree."""

    AUTO = "auto"
    AFFINE = "affine"
    PIXDIM = "pixdim"


class TissueLabels(WireModel):
    """An explicit label scheme: the label values of each tissue."""

    lv_cavity: list[int] = Field(default_factory=list, max_length=32)
    lv_wall: list[int] = Field(default_factory=list, max_length=32)
    rv_cavity: list[int] = Field(default_factory=list, max_length=32)
    rv_wall: list[int] = Field(default_factory=list, max_length=32)
    ignored: list[int] = Field(
        default_factory=list, max_length=64, description="Values that are not of the ventricles."
    )

    @model_validator(mode="after")
    def _is_a_partition(self) -> Self:
        lists = (self.lv_cavity, self.lv_wall, self.rv_cavity, self.rv_wall, self.ignored)
        values = [v for part in lists for v in part]
        if 0 in values:
            raise ValueError("0 is the background and cannot be a tissue")
        repeats = sorted(v for v, n in Counter(values).items() if n > 1)
        if repeats:
            raise ValueError(f"label values of two tissues: {repeats}; give each value once")
        if not any(lists[:4]):
            raise ValueError("name at least one tissue")
        return self


class LabelRequest(WireModel):
    """The JSON part of a label-map submission. The maps are file parts named by their view."""

    subject_id: Name
    label_scheme: LabelScheme | TissueLabels
    frame_labels: list[Name] | None = Field(
        default=None,
        max_length=256,
        description="One name a frame; left out, frames are called t00, t01, ...",
    )
    spacing: Spacing = Field(
        default=Spacing.AUTO,
        description="Which voxel size to believe when a header's affine and pixdim disagree.",
    )
    beyond_range: bool = Field(
        default=False,
        description="Empty short-axis slices beyond the labelled range are evidence of outside. "
        "By default they are unknown; empty slices inside the range always are evidence.",
    )
    options: Options = Field(default_factory=Options)

    @model_validator(mode="after")
    def _has_unique_frames(self) -> Self:
        names = [n.lower() for n in self.frame_labels or ()]
        if len(set(names)) != len(names):
            raise ValueError("`frame_labels` repeats a name; make them unique")
        return self
