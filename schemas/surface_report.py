"""One surface of one frame, measured. Lengths in mm."""

from typing import Literal

from pydantic import Field

from schemas.base import WireModel
from schemas.measures import DistanceSummary, Histogram
from schemas.reference_report import ReferenceReport
from schemas.vocabulary import Structure, ViewKind

Third = Literal["apex", "mid", "base"]
"""Apical, middle and basal third of a surface's extent along the short-axis normal."""


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
    contour_residual_by_view: dict[ViewKind, ViewResiduals] = Field(
        description="The same by kind of view; a kind without a contour of it is left out."
    )
    contour_residual_by_region_mm: dict[Third, DistanceSummary] = Field(
        description="The same in the apical, middle and basal third of the surface's extent along "
        "the short-axis normal; a third without a contour point is left out."
    )
    held_out_mm: DistanceSummary | None = Field(
        description="Distances from every slice's contours to the surface fitted without that "
        "slice, mm: usually more than the error between slices, for the gap is twice as wide. "
        "null unless `holdout` was asked for."
    )
    held_out_by_view_mm: dict[ViewKind, DistanceSummary] = Field(
        description="The same by kind of view."
    )
    deviation_mm: DistanceSummary | None = Field(
        description="Standard deviation at each vertex, along the normal, over the fits of the "
        "ensemble, mm. null unless `ensemble` was asked for."
    )
    reference: ReferenceReport | None = Field(description="null without a reference of it")
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
