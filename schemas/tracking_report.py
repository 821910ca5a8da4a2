"""One mesh carried through the cycle: how close it is, and whether it is sound. Lengths in mm."""

from pydantic import Field

from schemas.base import WireModel
from schemas.measures import DistanceSummary


class TrackedFrameReport(WireModel):
    """A tracked surface at one frame."""

    fit: bool = Field(description="Whether it can stand for the frame's own surface.")
    reasons: list[str] = Field(description="Why not, each with its remedy; empty when fit.")
    to_surface_mm: DistanceSummary = Field(
        description="Exact distances from points spread over the tracked mesh to the frame's own "
        "surface."
    )
    from_surface_mm: DistanceSummary = Field(description="And back.")
    turned_over: int = Field(
        description="Triangles against the mesh's own normals at all of their corners."
    )
    against_surface: int = Field(
        description="Triangles against the frame's own surface where it is nearest; at an end "
        "thinner than the triangles that may be the other side."
    )
    folded: int = Field(
        description="Triangles folded by over 150 degrees onto one that shares an edge."
    )
    self_intersections: int = Field(description="Pairs of triangles that pass through each other.")
    least_angle_deg: float
    below_20_deg_percent: float
    area_ratio_min: float = Field(description="Of a triangle's area to that at `rest_frame`.")
    area_ratio_max: float
    step_mean_mm: float = Field(description="How far vertices moved from the frame before.")
    step_max_mm: float


class TrackedSurfaceReport(WireModel):
    """A surface whose vertices and triangles are the same in all frames."""

    rest_frame: str = Field(description="The frame whose mesh was carried: of the largest volume.")
    vertices: int
    triangles: int
    drift_mean_mm: float | None = Field(
        default=None,
        description="How far from where they began vertices are when the mesh is carried on from "
        "the last frame onto the first surface again. null where the frames are no whole cycle.",
    )
    drift_max_mm: float | None = None
    not_observed: str = Field(description="What of the motion no contour shows.")
    frames: dict[str, TrackedFrameReport] = Field(description="By the frame's label.")
