"""The report: every frame of a reconstruction measured, and what follows from all together."""

from collections.abc import Mapping, Sequence
from dataclasses import replace

from schemas.options import Base, Options
from schemas.report import Provenance, Report
from schemas.vocabulary import Structure
from worker.artifacts.concerns import concerns
from worker.artifacts.contour_warnings import contour_warnings
from worker.artifacts.cycle_report import cycle_report
from worker.artifacts.frame_times import frame_times
from worker.artifacts.frames import measured_frames
from worker.artifacts.function_report import function_report
from worker.artifacts.measured import Measured
from worker.artifacts.support_warnings import support_warnings
from worker.artifacts.tracking_report import tracking_report
from worker.crew import Alone, Crew
from worker.observer import Observer, Unobserved
from worker.reconstruction.result import Reconstruction
from worker.surface_mesh import SurfaceMesh
from worker.tracking.tracked_surface import TrackedSurface


def measure(
    reconstruction: Reconstruction,
    *,
    options: Options,
    warnings: Sequence[str],
    provenance: Provenance,
    references: Mapping[str, SurfaceMesh] | None = None,
    tracked: Mapping[Structure, TrackedSurface] | None = None,
    observer: Observer | None = None,
    crew: Crew | None = None,
) -> Measured:
    """Measure a reconstruction.

    Contour residuals are exact distances, in mm, from the observed outlines' points, moved back by
    their slice's shift, to the surface. Long-axis chords at the valves are no observation and are
    not measured. A volume is only given for a watertight surface. Where a surface goes on beyond
    its short-axis slices and no long-axis contour follows it, and where views contradict each
    other, a warning is added. Times are not known yet: see `timed`.

    references: by surface (`ED_lv_endo`) what is taken for its truth, mm, the study's own axes.
    tracked: the surfaces that were carried through the frames.
    crew: who measures them.

    Raises:
        InternalError: where every frame has a surface that faces inward, or that no contour was
            observed of; one of several frames fails alone.
        Cancelled: the observer asked to stop.
    """
    measured, failed = measured_frames(
        reconstruction, options, references or {}, observer or Unobserved(), crew or Alone()
    )
    frames = [report for report, _ in measured]
    said = [
        *warnings,
        *(f"Frame {one.label} has no results: {one.reason}" for one in failed),
        *reconstruction.warnings,
        *(text for one in frames for text in contour_warnings(one.label, one.contour_noise_mm)),
        *(text for one in frames for text in support_warnings(one.label, one.surfaces)),
    ]
    stopped = reconstruction.stopped_early
    function = function_report(frames, stopped_early=stopped)
    tracking = tracking_report(tracked or {})
    study = reconstruction.study_frames
    whole = options.sequence.whole_cycle and not stopped
    times = frame_times(frames, study, is_whole_cycle=whole)
    report = Report(
        subject_id=reconstruction.subject_id,
        axes=reconstruction.axes,
        frames=frames,
        failed_frames=failed,
        study_frames=list(study),
        stopped_early=stopped,
        function=function,
        cycle=cycle_report(measured, tracked or {}, times, stopped_early=stopped),
        tracking=tracking,
        warnings=said,
        concerns=concerns(
            frames,
            said,
            function=function,
            tracking=tracking,
            open_base=options.base is Base.OPEN,
            stopped_early=stopped,
        ),
        timings_s={},
        options=options,
        provenance=provenance,
    )
    return Measured(report, [frame for _, frame in measured], tracked or {})


def timed(measured: Measured, timings_s: Mapping[str, float]) -> Measured:
    """The same with the seconds that every stage took."""
    report = measured.report.model_copy(update={"timings_s": dict(timings_s)})
    return replace(measured, report=report)
