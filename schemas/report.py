"""`report.json`: what was reconstructed and how far to trust it. Lengths in mm, patient axes."""

from typing import Literal

from pydantic import Field

from schemas.base import WireModel
from schemas.options import Options
from schemas.vocabulary import Axes, Structure, View


class DistanceSummary(WireModel):
    """Absolute distances, in mm, and how many were measured."""

    mean: float
    rms: float
    p50: float
    p90: float
    p95: float
    max: float
    count: int


class Histogram(WireModel):
    """How many distances lie in each bin of equal width, from 0 on."""

    bin_width_mm: float
    counts: list[int]
    beyond: int = Field(description="How many lie beyond the last bin.")


class ViewResiduals(WireModel):
    """Distances from the contours of one kind of view to the surface."""

    summary_mm: DistanceSummary
    histogram: Histogram


class SimulationReport(WireModel):
    """Whether a surface can go into a simulation as it is."""

    fit: bool
    reasons: list[str] = Field(description="Why not, each with its remedy; empty when fit.")


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
    components: int = Field(description="Pieces that share no vertex; 1 for one surface.")
    manifold: bool = Field(
        description="No edge has more than two triangles, and those about a vertex form one fan."
    )
    self_intersecting_triangles: int = Field(
        description="Triangles of it that pass through another of its own."
    )
    crossing_triangles: dict[Structure, int] = Field(
        description="Triangles of it that pass through each other surface of the frame."
    )
    simulation: SimulationReport
    contour_residual_mm: DistanceSummary
    contour_residual_by_view: dict[Literal["short_axis", "long_axis", "other"], ViewResiduals] = (
        Field(description="The same by kind of view; a kind without a contour of it is left out.")
    )
    contour_residual_by_region_mm: dict[Literal["apex", "mid", "base"], DistanceSummary] = Field(
        description="The same in the apical, middle and basal third of the surface's extent along "
        "the short-axis normal; a third without a contour point is left out."
    )
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
    dice: dict[Structure, float | None] = Field(
        description="Overlap on the slice's plane of what its contours enclose and what the "
        "surface does there, 1 at best; beyond the chord of an open contour it is not asked. null "
        "where the surface is open."
    )


class LevelReport(WireModel):
    """Mean losses over one refinement level."""

    level: int
    radius_mm: float
    samples: int
    bce: float
    hinge: float
    total: float


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
    wall_mass_g: float | None = Field(description="Volume of the wall times 1.05 g/mL, grams.")
    wall_thickness_mm: dict[int, SegmentReport] | None = Field(
        description="By number of the American Heart Association's 17 segments, mm: the exact "
        "distance from the inner surface to the outer one, in the apex (17) from the outer to the "
        "inner; up to the most basal short-axis slice that shows both in one contour each."
    )
    not_measured: dict[str, str] = Field(description="By name of what is null, the reason.")


class FrameReport(WireModel):
    """One instant of the cycle."""

    label: str
    time_ms: float | None
    contour_noise_mm: float | None = Field(
        description="How far long-axis contours miss the short-axis ones that they cross, beyond "
        "what shifts explain, mm (standard deviation): the unsteadiness of the contours, which "
        "no surface can follow. null where none cross."
    )
    surfaces: dict[Structure, SurfaceReport]
    left_ventricle: LeftVentricleReport
    slices: list[SliceReport]
    levels: list[LevelReport]


class FunctionReport(WireModel):
    """Pump function, when frames ED and ES both have a closed left-ventricular endocardium."""

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


class Report(WireModel):
    """Everything measured about one subject."""

    schema_version: str = "2.0"
    subject_id: str
    units: str = "mm"
    axes: Axes
    frames: list[FrameReport]
    function: FunctionReport | None = None
    warnings: list[str] = Field(default_factory=list)
    timings_s: dict[str, float]
    options: Options
    provenance: Provenance
