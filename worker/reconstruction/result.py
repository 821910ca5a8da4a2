"""What a reconstruction returns: surfaces in mm, shifts found, losses seen."""

from collections.abc import Mapping
from dataclasses import dataclass

from schemas.vocabulary import Axes, Structure, View
from worker.arrays import Points, Vector
from worker.surface_mesh import SurfaceMesh


@dataclass(frozen=True, eq=False)
class ContourPoints:
    """One observed outline: (n, 3) points in mm, and whether the last joins the first."""

    points_mm: Points
    closed: bool


@dataclass(frozen=True, eq=False)
class SliceFit:
    """One slice after the fit.

    shift_mm: (3,) how far the slice was found displaced from the heart, in its own plane, patient
        axes; the contours were moved back by it.
    contours_mm: per structure the observed outlines as given, (n, 3) each, in mm, not moved back.
    """

    id: str
    view: View
    shift_mm: Vector
    contours_mm: Mapping[Structure, tuple[ContourPoints, ...]]


@dataclass(frozen=True)
class LevelFit:
    """Losses of one refinement level, averaged over its iterations."""

    level: int
    radius_mm: float
    samples: int
    bce: float
    hinge: float
    total: float


@dataclass(frozen=True, eq=False)
class FrameFit:
    """One reconstructed instant of the cycle."""

    label: str
    time_ms: float | None
    surfaces: Mapping[Structure, SurfaceMesh]
    slices: tuple[SliceFit, ...]
    levels: tuple[LevelFit, ...]


@dataclass(frozen=True, eq=False)
class Reconstruction:
    """All frames of a subject, in mm and the study's own axes.

    Times are not here: whoever watches takes them from the stages that the observer is told of.
    """

    subject_id: str
    axes: Axes
    frames: tuple[FrameFit, ...]
