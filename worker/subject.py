"""One subject from contour study to files: the whole of a job but the job.

The Celery task and `neuralmri reconstruct` both come here, so their meshes are the same bytes.
"""

from collections.abc import Sequence
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
from worker.artifacts.evidence import SUPPORT, vertex_support_mm
from worker.artifacts.html import render_html
from worker.artifacts.manifest import describe
from worker.artifacts.meshes import write_mesh
from worker.artifacts.report import build_report, mesh_name
from worker.observer import Cancelled, Observer, Unobserved
from worker.provenance import provenance, software
from worker.reconstruction.result import Reconstruction
from worker.stage_clock import StageClock
from worker.threads import use_threads

_RECONSTRUCTED = 0.95
"""Fraction of the work that is done when the surfaces are there; the rest is measuring, writing."""


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
    observer: Observer | None = None,
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
        observer: Told of progress, asked whether to stop.
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
    reconstruction = _reconstruct(study, options, threads, clock)
    _enter(Stage.MEASURING, _RECONSTRUCTED, clock)
    unwritten = build_report(
        reconstruction,
        options=options,
        warnings=[*warnings, *admission],
        timings_s={},
        provenance=provenance(seed=options.seed, threads=threads, input_sha256=input_sha256),
    )
    _enter(Stage.WRITING, (1 + _RECONSTRUCTED) / 2, clock)
    _write_meshes(reconstruction, options, out_dir)
    report = unwritten.model_copy(update={"timings_s": clock.timings_s()})
    text = report.model_dump_json(indent=1) + "\n"
    (out_dir / "report.json").write_text(text, encoding="utf-8")
    (out_dir / "report.html").write_text(render_html(report), encoding="utf-8")
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
    study: ContourStudy, options: Options, threads: int, observer: Observer
) -> Reconstruction:
    use_threads(threads)
    # Loaded here, after the threads are bound, and never in a process that still forks.
    from worker.reconstruction.pipeline import reconstruct

    return reconstruct(study, options, _FirstPart(observer))


def _enter(stage: Stage, fraction: float, observer: Observer) -> None:
    if observer.is_cancelled():
        raise Cancelled
    observer.advanced(Progress(stage=stage, fraction=fraction))


def _write_meshes(reconstruction: Reconstruction, options: Options, out_dir: Path) -> None:
    for frame in reconstruction.frames:
        support_mm = vertex_support_mm(frame)
        for structure, mesh in frame.surfaces.items():
            name = mesh_name(frame.label, structure)
            at_vertices = {SUPPORT: support_mm[structure]}
            for form in dict.fromkeys(options.formats):
                path = out_dir / f"{name}.{form}"
                write_mesh(path, mesh, name, reconstruction.axes, at_vertices)


@dataclass(frozen=True)
class _FirstPart:
    """Passes a reconstruction's progress on as the first part of the whole."""

    whole: Observer

    def advanced(self, progress: Progress) -> None:
        fraction = _RECONSTRUCTED * progress.fraction
        self.whole.advanced(progress.model_copy(update={"fraction": fraction}))

    def is_cancelled(self) -> bool:
        return self.whole.is_cancelled()
