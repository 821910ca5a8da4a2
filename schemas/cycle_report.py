"""What follows from all frames of a cycle together. Series have one number for each of `frames`."""

from pydantic import Field

from schemas.base import WireModel
from schemas.vocabulary import Structure

Series = list[float | None]
"""By frame, in the order of `CycleReport.frames`; null where a frame does not have it."""

FEWEST_FRAMES = 3
"""Of a cycle; two are two instants."""


class ChamberCycleReport(WireModel):
    """A ventricle's cavity as a pump. Rates are of the volume curve, not of a pair of frames."""

    ed_frame: str = Field(description="Of its largest volume.")
    es_frame: str = Field(description="Of its smallest volume.")
    edv_ml: float
    esv_ml: float
    stroke_volume_ml: float
    ejection_fraction_percent: float
    peak_ejection_rate_ml_per_s: float | None = Field(
        description="Fastest fall of the volume, a positive number; null without times that grow."
    )
    peak_filling_rate_ml_per_s: float | None = Field(
        description="Fastest rise of the volume; null likewise."
    )
    jitter_ml: float | None = Field(
        description="Root mean square second difference of the volume curve over that of "
        "independent errors of 1 mL: errors from frame to frame are at most so large. null where "
        "no three frames of the study in a row have the volume; a step of over 1.5 median steps is "
        "a frame that is missing."
    )


class SpreadSeries(WireModel):
    """A number at every point of a surface, in a few numbers a frame, weighed by area: p5 is the
    value that 5 percent of the area have or less.
    """

    mean: Series
    p5: Series
    p50: Series
    p95: Series


class SurfaceCycleReport(WireModel):
    """One surface over the cycle."""

    volume_ml: Series = Field(description="null in frames where the surface is open.")
    area_cm2: Series
    area_change_percent: Series = Field(description="Of the whole surface, to `ed_frame`'s.")
    gaussian_curvature_per_mm2: SpreadSeries
    mean_curvature_per_mm: SpreadSeries
    area_strain_percent: SpreadSeries | None = Field(
        description="Of the area about each vertex of the tracked mesh, to `ed_frame`, weighed by "
        "the area there. Its mean is observed; how it is spread depends on the tangential motion, "
        "which contours do not show. null without `tracked_meshes`, and where `ed_frame` lacks the "
        "surface."
    )
    area_strain_by_segment_percent: dict[int, Series] | None = Field(
        description="Its mean by segment of the left ventricle's wall, as the tracked vertices lie "
        "at `ed_frame`; of lv_endo and lv_epi only. null likewise, and where the segments are not "
        "known."
    )
    above_p90_error_area_percent: Series = Field(
        description="Share of the area in the 90th-percentile error region; null in frames "
        "without a reference."
    )
    above_p75_curvature_area_percent: Series = Field(
        description="Share of the area in the 75th-percentile region of the deviation of Gaussian "
        "curvature; null likewise."
    )


class LeftVentricleCycleReport(WireModel):
    """Shortening and thickening of the left ventricle, to `ed_frame`; shortening is positive."""

    longitudinal_shortening_percent: Series = Field(
        description="Of the extent of the cavity along the short-axis normal."
    )
    circumferential_shortening_percent: Series = Field(
        description="Of the perimeter of the cavity across its long axis, half-way from apex to "
        "base."
    )
    wall_mass_g: Series
    wall_thickness_mm: dict[int, Series] = Field(description="By AHA segment, mean.")
    wall_thickening_percent: dict[int, Series] = Field(description="By AHA segment.")


class CycleReport(WireModel):
    """The cycle, of studies with three frames or more."""

    frames: list[str] = Field(description="Labels in the order of time.")
    times_ms: list[float] | None = Field(
        description="null where a frame of the study has no time of its own."
    )
    is_whole_cycle: bool = Field(
        description="What `sequence.whole_cycle` says; false where the job was stopped early."
    )
    period_ms: float | None = Field(
        default=None,
        description="From the study's first frame to its last, with results or not, and a median "
        "step to the next beat's first; null where the frames are no whole cycle, and without "
        "times that grow.",
    )
    ed_frame: str = Field(
        description="The frame that changes are measured from: of the largest left cavity; where "
        "none is closed, of the largest right one, else of the first surface that has a volume, or "
        "an area."
    )
    chambers: dict[Structure, ChamberCycleReport] = Field(
        description="lv_endo and rv_endo, those that are closed in three frames or more. "
        "None where the job was stopped early: the smallest volume may be missing."
    )
    surfaces: dict[Structure, SurfaceCycleReport]
    left_ventricle: LeftVentricleCycleReport
    not_observed: str | None = Field(
        default=None,
        description="What of `area_strain_percent` no contour shows; null without tracked meshes.",
    )
