"""The JSON part of a submission of contour files, and the settings of their formats."""

from enum import StrEnum

from pydantic import Field

from schemas.base import Name, WireModel
from schemas.options import Options
from schemas.vocabulary import Axes, Structure, Units, View


class ContourFormat(StrEnum):
    """A way in which other programs write contours."""

    GUIDE_POINTS = "guide_points"
    CSL = "csl"
    RTSTRUCT = "rtstruct"
    CVI42 = "cvi42"


class GuidePointSettings(WireModel):
    """What guide-point files do not say."""

    rr_interval_ms: float | None = Field(
        default=None,
        gt=0.0,
        le=5000.0,
        description="Length of the cardiac cycle, ms. With it numbered frames get their times: "
        "they are taken to be spread evenly over the cycle, all of which is sent.",
    )
    views: dict[Name, View] = Field(
        default_factory=dict,
        max_length=256,
        description="Views of slices by their ids, for long-axis slices that are told wrongly.",
    )


class CslSettings(WireModel):
    """What cross-section files do not say."""

    structures: dict[str, Structure] = Field(
        default_factory=dict,
        max_length=64,
        description="Structures by their labels in the files. Left out, each file is of the "
        "structure that its name ends in, as in `ED_lv_endo.csl`.",
    )
    units: Units = Units.MM
    axes: Axes = Axes.LPS


class RtstructSettings(WireModel):
    """What DICOM RT Structure Sets do not say."""

    structures: dict[str, Structure] = Field(
        default_factory=dict,
        max_length=64,
        description="Structures by the names of regions (ROI Name), whole and in any case. Goes "
        "before the names that are known; what neither knows is left out with a warning.",
    )


class ContourFilesRequest(WireModel):
    """The part `request` of `POST /v1/jobs/files`. The files are parts called `file`."""

    subject_id: Name = "subject"
    format: ContourFormat | None = Field(
        default=None, description="Left out, it is told by the files' content."
    )
    guide_points: GuidePointSettings = Field(default_factory=GuidePointSettings)
    csl: CslSettings = Field(default_factory=CslSettings)
    rtstruct: RtstructSettings = Field(default_factory=RtstructSettings)
    options: Options = Field(default_factory=Options)
