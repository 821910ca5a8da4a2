"""A surface held against a reference of it. Lengths in mm."""

from typing import Literal

from pydantic import Field

from schemas.base import WireModel
from schemas.measures import DistanceSummary
from schemas.vocabulary import ViewKind

Region = Literal["apex", "mid", "base", "septum", "free_wall"]
"""Thirds of a surface's extent along the short-axis normal, and what faces the other ventricle."""


class PointSetReport(WireModel):
    """The method's own measures, between as many points drawn on either surface: not zero even for
    one surface, since the points differ. Definitions: docs/method.md.
    """

    points: int = Field(description="Drawn on either surface.")
    chamfer_mm2: float = Field(description="Mean square from each set to the other, summed, mm2.")
    rms_chamfer_mm: float = Field(description="Root of half of it, mm.")
    hausdorff_mm: float
    hausdorff50_mm: float
    hausdorff90_mm: float
    hausdorff95_mm: float
    rmse_mm: float
    mae_mm: float
    optimal_threshold_mm: float = Field(
        description="90th percentile of the distances from the surface's points to the reference's."
    )


class CurvatureDeviationReport(WireModel):
    """Curvature of the reference minus the surface's, in the unit that the name of this object ends
    in, weighed by area.
    """

    mean_abs: float
    rms: float
    p75_abs: float
    p90_abs: float
    reference_rms: float = Field(description="Of the reference's own curvature.")
    above_p75_area_percent: float = Field(
        description="Share of the area whose deviation is above the 75th percentile of its "
        "vertices, percent."
    )
    mean_abs_by_region: dict[Region, float] = Field(
        description="A region without a vertex is left out."
    )


class CurvatureReport(WireModel):
    """How differently both bend, remeshed to one edge length."""

    edge_mm: float
    gaussian_per_mm2: CurvatureDeviationReport
    mean_per_mm: CurvatureDeviationReport
    gauss_bonnet_residual_rad: float = Field(
        description="What angle deficits sum to beyond 2 pi times the Euler number: rounding."
    )


class PlanesReport(WireModel):
    """Both surfaces cut by the slices' planes of one kind of view."""

    planes: int = Field(description="Which cut both surfaces.")
    distance_mm: DistanceSummary = Field(
        description="In-plane distances between both contours, from points of each to the other."
    )
    dice_mean: float = Field(description="Overlap of what both enclose, mean over planes.")
    dice_min: float


class PlacementReport(WireModel):
    """The rigid motion that was found to lay the surface onto the reference, for measuring only."""

    rotation_deg: float
    translation_mm: tuple[float, float, float] = Field(description="Of the surface's centroid.")


class ReferenceReport(WireModel):
    """Measures of a surface against its reference. What could not be measured is null, and
    `not_measured` says why.
    """

    volume_ml: float | None = Field(description="Of the reference; null when it is open.")
    volume_difference_percent: float | None = Field(
        description="Surface minus reference, of the reference's."
    )
    mean_mm: float = Field(description="Mean of both directed means; exact, point to triangle.")
    rms_mm: float
    hausdorff95_mm: float = Field(description="The larger of both directed 95th percentiles.")
    hausdorff_mm: float
    to_reference_mm: DistanceSummary = Field(description="From the surface to the reference.")
    from_reference_mm: DistanceSummary = Field(description="From the reference to the surface.")
    by_region_mm: dict[Region, DistanceSummary] = Field(
        description="From the surface to the reference, by where on the surface; a region without "
        "a point is left out."
    )
    above_p90_area_percent: float = Field(
        description="Share of the surface's area that is further from the reference than the 90th "
        "percentile of its vertices, percent."
    )
    by_view: dict[ViewKind, PlanesReport] = Field(
        description="By kind of view; a kind whose planes do not cut both is left out."
    )
    point_set: PointSetReport
    curvature: CurvatureReport | None
    placement: PlacementReport | None = Field(
        description="null unless `reference.align` was asked for"
    )
    not_measured: dict[str, str] = Field(description="By name of what is null, the reason.")
