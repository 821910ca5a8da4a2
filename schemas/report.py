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


class SurfaceReport(WireModel):
    """One surface of one frame."""

    volume_ml: float | None = Field(description="null when the surface is open at the base")
    area_cm2: float
    watertight: bool
    vertices: int
    faces: int
    euler_number: int
    contour_residual_mm: DistanceSummary
    files: list[str]


class SliceReport(WireModel):
    """One slice of one frame."""

    id: str
    view: View
    shift_mm: tuple[float, float, float] = Field(
        description="How far the slice was found displaced from the heart, in its own plane, in "
        "patient axes; its contours were moved back by as much."
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
