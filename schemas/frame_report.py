"""One instant of the cycle: its surfaces, slices, fit and left ventricle. Lengths in mm."""

from pydantic import Field

from schemas.base import WireModel
from schemas.measures import DistanceSummary
from schemas.surface_report import SurfaceReport
from schemas.vocabulary import Structure, View


class SliceReport(WireModel):
    """One slice of one frame."""

    id: str
    view: View
    shift_mm: tuple[float, float, float] = Field(
        description="How far the slice was found displaced from the heart, in its own plane, in "
        "patient axes; its contours were moved back by as much."
    )
    shift_deviation_mm: float | None = Field(
        description="Standard deviation of the shift along its least certain direction in the "
        "plane. null where no long-axis contour crosses the slice's contours: its shift, if any, "
        "rests on smoothness alone."
    )
    crossings: int = Field(
        description="Points of long-axis contours in the slice's plane that the shift rests on."
    )
    rotation_deg: float = Field(
        description="How far the slice was found turned in its own plane, about the middle of its "
        "contours, right-handed about the slice's normal; 0 unless alignment.rotate was asked for."
    )
    contour_residual_mm: dict[Structure, DistanceSummary]
    held_out_mm: dict[Structure, DistanceSummary] = Field(
        description="Distances from its contours to the surface fitted without this slice, mm; "
        "empty unless `holdout` was asked for."
    )
    dice: dict[Structure, float | None] = Field(
        description="Overlap on the slice's plane of what its contours enclose and what the "
        "surface does there, 1 at best; beyond the chord of an open contour it is not asked. null "
        "where the surface is open."
    )


class LossCurves(WireModel):
    """Losses of every iteration of one level, in order. total = bce + loss.hinge_weight * hinge."""

    bce: list[float]
    hinge: list[float]
    total: list[float]


class LevelReport(WireModel):
    """Mean losses over one refinement level, and the losses of its iterations."""

    level: int
    radius_mm: float
    samples: int
    bce: float
    hinge: float
    total: float
    iterations: LossCurves


class SegmentReport(WireModel):
    """Thickness of one segment of the left ventricle's wall, mm."""

    name: str
    mean_mm: float
    min_mm: float
    max_mm: float


class LeftVentricleReport(WireModel):
    """Shape and wall of the left ventricle. What could not be measured is null, and
    `not_measured` says why.
    """

    long_axis_length_mm: float | None = Field(
        description="Extent of the cavity along the short-axis normal, mm."
    )
    sphericity: float | None = Field(
        description="Volume of the cavity over that of a sphere as wide as it is long; 1 for a "
        "sphere."
    )
    mid_area_cm2: float | None = Field(
        description="Area of the cavity across its long axis, half-way from apex to base, cm2."
    )
    mid_perimeter_mm: float | None = Field(
        default=None, description="Length of that section's outline, mm."
    )
    wall_mass_g: float | None = Field(description="Volume of the wall times 1.05 g/mL, grams.")
    wall_thickness_mm: dict[int, SegmentReport] | None = Field(
        description="By number of the American Heart Association's 17 segments, mm: the exact "
        "distance from the inner surface to the outer one, in the apex (17) from the outer to the "
        "inner; up to the most basal short-axis slice that shows both in one contour each."
    )
    not_measured: dict[str, str] = Field(description="By name of what is null, the reason.")


class StudyFrame(WireModel):
    """One instant of the study, whether it has results or not."""

    label: str
    time_ms: float | None


class FailedFrameReport(WireModel):
    """One instant of several that no surface was found of, or none fit to be handed out."""

    label: str
    reason: str = Field(description="What was wrong, and what to do about it.")


class FrameReport(WireModel):
    """One instant of the cycle."""

    label: str
    time_ms: float | None
    started_from: str | None = Field(
        default=None,
        description="The frame whose field the fit went on from; null for a fit from nothing.",
    )
    contour_noise_mm: float | None = Field(
        description="How far long-axis contours miss the short-axis ones that they cross, beyond "
        "what shifts explain, mm (standard deviation): the unsteadiness of the contours, which "
        "no surface can follow. null where none cross."
    )
    surfaces: dict[Structure, SurfaceReport]
    left_ventricle: LeftVentricleReport
    slices: list[SliceReport]
    levels: list[LevelReport]
