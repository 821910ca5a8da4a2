"""`report.json`: what was reconstructed and how far to trust it. Lengths in mm, patient axes."""

from typing import Literal

from pydantic import Field

from schemas.base import WireModel
from schemas.cycle_report import CycleReport
from schemas.frame_report import FailedFrameReport, FrameReport, StudyFrame
from schemas.options import Options
from schemas.tracking_report import TrackedSurfaceReport
from schemas.vocabulary import Axes, Structure


class FunctionReport(WireModel):
    """Pump function: of frames named ED and ES where there are both, else, where three frames or
    more have the left cavity closed and the job was not stopped early, of those where it is largest
    and smallest.
    """

    ed_frame: str | None = Field(
        default=None, description="The frame taken for end-diastole; null outside of a report."
    )
    es_frame: str | None = Field(default=None, description="And for end-systole.")
    lv_edv_ml: float
    lv_esv_ml: float
    lv_stroke_volume_ml: float
    lv_ejection_fraction_percent: float
    lv_fractional_area_change_percent: float | None = Field(
        default=None,
        description="How much smaller the cavity's area half-way from apex to base is at ES; null "
        "where it could not be measured in both frames.",
    )
    rv_edv_ml: float | None = Field(
        default=None, description="null, as all of the right, unless both frames have it closed."
    )
    rv_esv_ml: float | None = None
    rv_stroke_volume_ml: float | None = None
    rv_ejection_fraction_percent: float | None = None


class Provenance(WireModel):
    """What is needed to produce the same again."""

    software: str
    python: str
    libraries: dict[str, str]
    seed: int
    threads: int
    input_sha256: str


class Concern(WireModel):
    """One thing to look at before the surfaces are used, and what to do about it."""

    severity: Literal["grave", "notable"] = Field(
        description="grave: do not use the surface before this is resolved."
    )
    text: str


class Report(WireModel):
    """Everything measured about one subject."""

    schema_version: Literal["3.0"] = "3.0"
    subject_id: str
    units: str = "mm"
    axes: Axes
    frames: list[FrameReport]
    failed_frames: list[FailedFrameReport] = Field(
        default_factory=list,
        description="Frames of the study without results, while others have them.",
    )
    study_frames: list[StudyFrame] = Field(
        default_factory=list,
        description="Every frame of the study in its order, with results or without.",
    )
    stopped_early: bool = Field(
        default=False,
        description="Whether frames are missing because the job was cancelled with `keep_frames`.",
    )
    function: FunctionReport | None = None
    cycle: CycleReport | None = Field(
        default=None, description="Of studies with three frames or more."
    )
    tracking: dict[Structure, TrackedSurfaceReport] = Field(
        default_factory=dict, description="Empty unless `tracked_meshes` was asked for."
    )
    warnings: list[str] = Field(default_factory=list)
    concerns: list[Concern] = Field(description="What to worry about, the gravest first.")
    timings_s: dict[str, float]
    options: Options
    provenance: Provenance
