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
from worker.artifacts.display_meshes import display_meshes
from worker.artifacts.manifest import describe
from worker.artifacts.measured import Measured
from worker.artifacts.page.html import render_html
from worker.artifacts.playback import write_playback
from worker.artifacts.report import measure, timed
from worker.checkpoints import Checkpoints
from worker.crew import Crew
from worker.helped_crew import crew_of
from worker.mesh_artifacts import write_meshes
from worker.observer import (
    Cancelled,
    Finishing,
    KeepsFound,
    Observer,
    Unobserved,
    nothing_kept,
)
from worker.progress_share import ProgressShare
from worker.provenance import provenance, software
from worker.reconstruction.result import Reconstruction, StoppedEarly
from worker.stage_clock import StageClock
from worker.surface_mesh import SurfaceMesh
from worker.threads import use_threads
from worker.tracked_meshes import tracked_surfaces
from worker.work_shares import work_shares

_MESHES, _THINNED, _PLAYED = 0.3, 0.6, 0.7
"""Of writing, where each ends; the rest is the page."""


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
    processes: int = 1,
    input_sha256: str,
    warnings: Sequence[str] = (),
    references: Mapping[str, SurfaceMesh] | None = None,
    job_id: str | None = None,
    observer: Observer | None = None,
    keeps_found: KeepsFound = nothing_kept,
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
        processes: That work on frames of the study at a time, threads each. No part of the result.
        input_sha256: Of what the caller sent, for the report.
        warnings: What was noticed on the way to the study, for the report.
        references: By surface (`ED_lv_endo`) what is taken for its truth, mm, the study's own axes.
        job_id: Said in the files, where there is a job.
        observer: Told of progress, asked whether to stop.
        keeps_found: Asked, once it has asked to stop, whether the frames that were finished by then
            are to be measured and written.
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
    shares = work_shares(study, options)
    with crew_of(processes if len(study.frames) > 1 else 1, threads) as crew:
        try:
            reconstruction = _reconstruct(
                study,
                options,
                threads,
                ProgressShare(clock, 0.0, shares.reconstructed),
                checkpoints,
                crew,
            )
        except StoppedEarly as stopped:
            if not keeps_found():
                raise
            reconstruction = stopped.found
        rest = Finishing(clock, keeps_found)
        _enter(Stage.MEASURING, shares.reconstructed, rest)
        tracking = ProgressShare(rest, shares.reconstructed, shares.tracked)
        tracked, untracked = tracked_surfaces(reconstruction, options, tracking, crew)
        measured = measure(
            reconstruction,
            options=options,
            warnings=[*warnings, *admission, *untracked],
            provenance=provenance(seed=options.seed, threads=threads, input_sha256=input_sha256),
            references=references,
            tracked=tracked,
            observer=ProgressShare(rest, shares.tracked, shares.measured),
            crew=crew,
        )
        _enter(Stage.WRITING, shares.measured, rest)
        writing = ProgressShare(rest, shares.measured, 1.0)
        report = _write(measured, out_dir, job_id, clock, writing, crew)
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
    crew: Crew,
) -> Reconstruction:
    use_threads(threads)
    # Loaded here, after the threads are bound, and never in a process that still forks.
    from worker.reconstruction.pipeline import reconstruct

    return reconstruct(study, options, observer, checkpoints, crew)


def _write(
    measured: Measured,
    out_dir: Path,
    job_id: str | None,
    clock: StageClock,
    observer: Observer,
    crew: Crew,
) -> Report:
    """Everything but the manifest. The report has the times up to where its own writing begins."""
    write_meshes(measured, out_dir, job_id, ProgressShare(observer, 0.0, _MESHES), crew)
    thinned = display_meshes(measured, ProgressShare(observer, _MESHES, _THINNED), crew)
    playing = ProgressShare(observer, _THINNED, _PLAYED)
    write_playback(measured, measured.report.options, out_dir, job_id, playing, thinned)
    measured = timed(measured, clock.timings_s())
    text = measured.report.model_dump_json(indent=1) + "\n"
    (out_dir / "report.json").write_text(text, encoding="utf-8")
    page = render_html(measured, ProgressShare(observer, _PLAYED, 1.0), crew, thinned)
    (out_dir / "report.html").write_text(page, encoding="utf-8")
    return measured.report


def _enter(stage: Stage, fraction: float, observer: Observer) -> None:
    if observer.is_cancelled():
        raise Cancelled
    observer.advanced(Progress(stage=stage, fraction=fraction))
