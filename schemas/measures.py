"""Many distances in a few numbers. Lengths in mm."""

from pydantic import Field

from schemas.base import WireModel


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
