"""What a reconstruction returns: surfaces in mm, shifts found, losses seen."""

from collections.abc import Mapping
from dataclasses import dataclass, field

from schemas.frame_report import StudyFrame
from schemas.vocabulary import Axes, Structure, View
from worker.arrays import Points, SomeScalars, Vector
from worker.observer import Cancelled
from worker.reconstruction.motion import moved_back
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
    shift_deviation_mm: its standard deviation along the least certain direction in the plane; None
        where no long-axis contour crosses the slice's own.
    crossings: how many points of long-axis contours the shift rests on.
    turn_rad: how far the slice was found turned about `normal` at `pivot_mm`, right-handed.
    contours_mm: per structure the observed outlines as given, (n, 3) each, in mm, not moved back.
    """

    id: str
    view: View
    normal: Vector
    shift_mm: Vector
    shift_deviation_mm: float | None
    crossings: int
    turn_rad: float
    pivot_mm: Vector
    contours_mm: Mapping[Structure, tuple[ContourPoints, ...]]

    def aligned_mm(self, points_mm: Points) -> Points:
        """Points (n, 3) of this slice's contours, mm, moved back to where the heart is."""
        return moved_back(points_mm, self.shift_mm, self.turn_rad, self.pivot_mm, self.normal)


@dataclass(frozen=True, eq=False)
class LevelFit:
    """One refinement level: samples in its mix, and the losses of its iterations, in order.

    bce, hinge, total: (iterations,) each; the total is the cross-entropy and the weighted hinge.
    """

    level: int
    radius_mm: float
    samples: int
    bce: SomeScalars
    hinge: SomeScalars
    total: SomeScalars


@dataclass(frozen=True, eq=False)
class LevelSetCurvature:
    """Curvature of the field's level set at the (n,) vertices of a surface.

    gaussian_per_mm2: 1/mm2. mean_per_mm: mean of the principal ones, 1/mm, positive where convex.
    """

    gaussian_per_mm2: SomeScalars
    mean_per_mm: SomeScalars


@dataclass(frozen=True, eq=False)
class FrameFit:
    """One reconstructed instant of the cycle.

    contour_noise_mm: standard deviation of what outlines that cross miss each other by, beyond what
        shifts explain; None where none cross.
    unremeshed: the surfaces before remeshing, where a target edge length was asked for; else none.
    curvature: of each surface, at its vertices.
    held_out: by slice id, where asked for, the surfaces that were fitted without that slice; those
        that no other slice shows are left out.
    members: where asked for, the surfaces of further fits with other seeds.
    started_from: the frame whose field the fit went on from; None for a fit from nothing.
    """

    label: str
    time_ms: float | None
    surfaces: Mapping[Structure, SurfaceMesh]
    slices: tuple[SliceFit, ...]
    levels: tuple[LevelFit, ...]
    contour_noise_mm: float | None = None
    unremeshed: Mapping[Structure, SurfaceMesh] = field(default_factory=dict)
    curvature: Mapping[Structure, LevelSetCurvature] = field(default_factory=dict)
    held_out: Mapping[str, Mapping[Structure, SurfaceMesh]] = field(default_factory=dict)
    members: tuple[Mapping[Structure, SurfaceMesh], ...] = ()
    started_from: str | None = None


@dataclass(frozen=True)
class FailedFrame:
    """A frame of several that no surface was found of, and why."""

    label: str
    reason: str


@dataclass(frozen=True, eq=False)
class Reconstruction:
    """All frames of a subject, in mm and the study's own axes.

    failed: frames that are not among `frames`. warnings: what was noticed over all frames.
    stopped_early: whether frames are missing because the observer asked to stop. study_frames: all
    of the study, in its order.

    Times are not here: whoever watches takes them from the stages that the observer is told of.
    """

    subject_id: str
    axes: Axes
    frames: tuple[FrameFit, ...]
    failed: tuple[FailedFrame, ...] = ()
    warnings: tuple[str, ...] = ()
    stopped_early: bool = False
    study_frames: tuple[StudyFrame, ...] = ()


class StoppedEarly(Cancelled):
    """The observer asked to stop when some frames were finished: `found` has these."""

    def __init__(self, found: Reconstruction) -> None:
        super().__init__(f"{len(found.frames)} frames were finished.")
        self.found = found
