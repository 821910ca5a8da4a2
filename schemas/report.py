"""`report.json`: what was reconstructed and how far to trust it. Lengths in mm, patient axes."""

from pydantic import Field

from schemas.base import WireModel
from schemas.options import Options
from schemas.vocabulary import Axes, Structure, View


class DistanceSummary(WireModel):
    """Absolute distances, in mm, and how many were measured."""

    mean: float
    rms: float
    p95: float
    max: float
    count: int


class QualityReport(WireModel):
    """Shape of a surface's triangles: neither needles nor caps are fit for a simulation."""

    min_angle_deg: float = Field(description="Smallest angle of all triangles, degrees; best 60.")
    min_angle_p5_deg: float = Field(
        description="5th percentile of the triangles' smallest angles, degrees."
    )
    min_angle_mean_deg: float = Field(description="Mean of their smallest angles, degrees.")
    below_20_deg_percent: float = Field(
        description="Share of triangles with an angle under 20 degrees, percent."
    )
    aspect_ratio_mean: float | None = Field(
        description="Circumradius over twice the inradius, 1 at best; null when a triangle has no "
        "area."
    )
    aspect_ratio_p95: float | None
    aspect_ratio_max: float | None
    edge_mean_mm: float
    edge_p5_mm: float
    edge_p95_mm: float


class EndReport(WireModel):
    """Apex or base of a surface: what lies beyond the last short-axis slice that shows it."""

    height_mm: float = Field(
        description="How far the surface goes on beyond that slice, along the slices' normal, mm; "
        "0 when it ends before."
    )
    support_max_mm: float = Field(
        description="Largest distance from the surface there to the nearest contour of it, mm."
    )
    on_long_axis: bool = Field(
        description="Whether a contour of another view follows the surface for half of that height "
        "or more. If not, the shape there is extrapolated."
    )


class SurfaceReport(WireModel):
    """One surface of one frame."""

    volume_ml: float | None = Field(description="null when the surface is open at the base")
    area_cm2: float
    watertight: bool
    vertices: int
    faces: int
    euler_number: int
    contour_residual_mm: DistanceSummary
    quality: QualityReport
    quality_before_remeshing: QualityReport | None = Field(
        description="null when `target_edge_mm` is not given"
    )
    remeshing_distance_mm: DistanceSummary | None = Field(
        description="Exact distances between the surface and what it was before remeshing, both "
        "ways, mm: mean and rms over both, p95 and max of the larger. null when `target_edge_mm` "
        "is not given."
    )
    support_mm: DistanceSummary = Field(
        description="Distance from the surface's vertices to the nearest observed contour of it, "
        "moved back by its slice's shift, mm. PLY and VTP files have it for every vertex."
    )
    slice_gap_mm: float | None = Field(
        description="Median distance between neighbouring short-axis slices that show it, mm; "
        "null when fewer than two do."
    )
    beyond_slice_gap_percent: float | None = Field(
        description="Share of the area that is further than one slice gap from any contour of it, "
        "percent."
    )
    apex: EndReport | None = Field(description="null when no short-axis slice shows the surface")
    base: EndReport | None = Field(description="null when no short-axis slice shows the surface")
    files: list[str]


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


class LevelReport(WireModel):
    """Mean losses over one refinement level."""

    level: int
    radius_mm: float
    samples: int
    bce: float
    hinge: float
    total: float


class FrameReport(WireModel):
    """One instant of the cycle."""

    label: str
    time_ms: float | None
    outline_noise_mm: float | None = Field(
        description="How far long-axis contours miss the short-axis ones that they cross, beyond "
        "what shifts explain, mm (standard deviation): the unsteadiness of the contours, which "
        "no surface can follow. null where none cross."
    )
    surfaces: dict[Structure, SurfaceReport]
    slices: list[SliceReport]
    levels: list[LevelReport]


class FunctionReport(WireModel):
    """Left-ventricular pump function, when frames ED and ES are both there."""

    lv_edv_ml: float
    lv_esv_ml: float
    lv_stroke_volume_ml: float
    lv_ejection_fraction_percent: float


class Provenance(WireModel):
    """What is needed to produce the same again."""

    software: str
    python: str
    libraries: dict[str, str]
    seed: int
    threads: int
    input_sha256: str


class Report(WireModel):
    """Everything measured about one subject."""

    schema_version: str = "1.0"
    subject_id: str
    units: str = "mm"
    axes: Axes
    frames: list[FrameReport]
    function: FunctionReport | None = None
    warnings: list[str] = Field(default_factory=list)
    timings_s: dict[str, float]
    options: Options
    provenance: Provenance
