"""One subject from contour study to files: the whole of a job but the job.

The Celery task and `neuralmri reconstruct` both come here, so their meshes are the
same bytes, but for the job that a file names.
"""

from collections.abc import Mapping, Sequence
from dataclasses import dataclass
from datetime import UTC, datetime
from pathlib import Path

from intake.limits import Limits
from intake.study import DEFAULT_LIMITS, admit
from schemas.artifacts import Manifest
from schemas.job import Progress, Stage
from schemas.options import Options
from schemas.report import Report
from schemas.study import ContourStudy
from schemas.surface_name import SurfaceName
from schemas.vocabulary import Axes, Structure
from worker.artifacts.manifest import describe
from worker.artifacts.measured import Measured
from worker.artifacts.meshes import write_mesh
from worker.artifacts.page.html import render_html
from worker.artifacts.report import measure, timed
from worker.checkpoints import Checkpoints
from worker.observer import Cancelled, Observer, Unobserved
from worker.part_of_whole import PartOfWhole
from worker.provenance import provenance, software
from worker.reconstruction.result import Reconstruction
from worker.stage_clock import StageClock
from worker.surface_mesh import SurfaceMesh
from worker.threads import use_threads
from worker.tracked_meshes import tracked_surfaces
from worker.tracking.tracked_surface import TrackedSurface
from worker.work_shares import work_shares


@dataclass(frozen=True)
class Finished:
    """What was found, and what was written; the manifest itself is not written yet."""

    report: Report
    manifest: Manifest


def run(
    study: ContourStudy,
    options: Options,
    out_dir: Path,
    *,
    threads: int,
    input_sha256: str,
    warnings: Sequence[str] = (),
    references: Mapping[str, SurfaceMesh] | None = None,
    job_id: str | None = None,
    observer: Observer | None = None,
    checkpoints: Checkpoints | None = None,
    pointer: str = "/study",
    limits: Limits = DEFAULT_LIMITS,
) -> Finished:
    """Admit, reconstruct, measure and write one subject.

    Args:
        study: In its own units and axes.
        options: What the caller chose.
        out_dir: An empty folder; meshes, `report.json` and `report.html` are written into it.
        threads: Of the arithmetic. Part of the result: another count, other last digits.
        input_sha256: Of what the caller sent, for the report.
        warnings: What was noticed on the way to the study, for the report.
        references: By surface (`ED_lv_endo`) what is taken for its truth, mm, the study's own axes.
        job_id: Said in the files, where there is a job.
        observer: Told of progress, asked whether to stop.
        checkpoints: Where fits are kept level by level, and gone on from.
        pointer: Where the study stands in what the caller sent, "" for a document of its own.
        limits: Counts that the study may reach.

    Raises:
        InputError: the study cannot be reconstructed; the detail names the remedy.
        InternalError: a surface was not found, or is not fit to be handed out.
        Cancelled: the observer asked to stop. `out_dir` may hold some of the files.
    """
    clock = StageClock(observer or Unobserved())
    clock.advanced(Progress(stage=Stage.READING))
    admission = admit(study, options, limits, pointer=pointer)
    shares, whole = work_shares(study, options), PartOfWhole(clock, 0.0, 1.0)
    reconstructing = whole.part(0.0, shares.reconstructed)
    reconstruction = _reconstruct(study, options, threads, reconstructing, checkpoints)
    _enter(Stage.MEASURING, shares.reconstructed, clock)
    tracking = whole.part(shares.reconstructed, shares.tracked)
    tracked, untracked = tracked_surfaces(reconstruction, options, tracking)
    unwritten = measure(
        reconstruction,
        options=options,
        warnings=[*warnings, *admission, *untracked],
        provenance=provenance(seed=options.seed, threads=threads, input_sha256=input_sha256),
        references=references,
        tracked=tracked,
        observer=whole.part(shares.tracked, shares.measured),
    )
    _enter(Stage.WRITING, shares.measured, clock)
    _write_meshes(unwritten, options, out_dir, job_id, whole.part(shares.measured, 1.0))
    _write_tracked(tracked, study.axes, options, out_dir, job_id)
    measured = timed(unwritten, clock.timings_s())
    report = measured.report
    text = report.model_dump_json(indent=1) + "\n"
    (out_dir / "report.json").write_text(text, encoding="utf-8")
    (out_dir / "report.html").write_text(render_html(measured), encoding="utf-8")
    manifest = describe(
        out_dir,
        subject_id=study.subject_id,
        axes=study.axes,
        software=software(),
        created_at=datetime.now(UTC),
    )
    clock.advanced(Progress(stage=Stage.DONE, fraction=1.0))
    return Finished(report, manifest)


def _reconstruct(
    study: ContourStudy,
    options: Options,
    threads: int,
    observer: Observer,
    checkpoints: Checkpoints | None,
) -> Reconstruction:
    use_threads(threads)
    # Loaded here, after the threads are bound, and never in a process that still forks.
    from worker.reconstruction.pipeline import reconstruct

    return reconstruct(study, options, observer, checkpoints)


def _enter(stage: Stage, fraction: float, observer: Observer) -> None:
    if observer.is_cancelled():
        raise Cancelled
    observer.advanced(Progress(stage=stage, fraction=fraction))


def _write_meshes(
    measured: Measured, options: Options, out_dir: Path, job_id: str | None, observer: Observer
) -> None:
    for index, frame in enumerate(measured.frames):
        done = index / (len(measured.frames) + 1)  # The last part is the page.
        observer.advanced(Progress(stage=Stage.WRITING, frame=frame.label, fraction=done))
        for structure, surface in frame.surfaces.items():
            name = str(SurfaceName(frame.label, structure))
            for form in dict.fromkeys(options.formats):
                path = out_dir / f"{name}.{form}"
                axes = measured.report.axes
                write_mesh(path, surface.mesh, name, axes, surface.fields, job_id=job_id)


def _write_tracked(
    tracked: Mapping[Structure, TrackedSurface],
    axes: Axes,
    options: Options,
    out_dir: Path,
    job_id: str | None,
) -> None:
    for structure, surface in tracked.items():
        for index, frame in enumerate(surface.frames):
            name = str(SurfaceName(frame.label, structure))
            for form in dict.fromkeys(options.formats):
                path = out_dir / f"{name}_tracked.{form}"
                write_mesh(path, surface.mesh(index), name, axes, job_id=job_id)
