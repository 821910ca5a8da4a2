"""A real heart's cycle from its raw guide points: what a run costs, and what its volumes are."""

from collections.abc import Mapping, Sequence
from pathlib import Path

from benchmarks.beating.fits import Fitted, fitted_from_nothing, two_processes
from benchmarks.beating.fitted_cycle import fitted_cycle
from benchmarks.beating.real_run import RealRun, real_run
from benchmarks.beating.results import RealCycle, Residuals, RunRow
from benchmarks.beating.spread_out import spread_out
from benchmarks.environment import environment
from intake.formats.guide_points import read_guide_points
from schemas.cycle_report import Series
from schemas.messages import ContourRequest
from schemas.options import Options
from schemas.report import Report
from schemas.vocabulary import Structure
from worker.evaluation.size import volume_ml
from worker.surface_mesh import SurfaceMesh

GUIDE_POINTS = "bivme_guide_points/patient1"
MODEL = "bivme_guide_points/fitted_surfaces_patient1.npz"
_SURFACES = [Structure.LV_ENDO, Structure.LV_EPI, Structure.RV_ENDO]


def real_cycle(
    data: Path,
    wanted: int | None = None,
    options: Options | None = None,
    processes: Sequence[int] = (1, 2),
) -> RealCycle:
    """data: the folder that has `GUIDE_POINTS` and `MODEL`. wanted: frames, for a short run.
    processes: of one run each; surfaces and residuals are those of the first.
    """
    where = environment()
    request = guide_point_request(data / GUIDE_POINTS, wanted, options or Options())
    runs = {count: real_run(request, count) for count in processes}
    with two_processes() as pool:
        alone = fitted_from_nothing(pool, request.study, request.options)()
    labels = [frame.label for frame in request.study.frames]
    times_ms = [frame.time_ms for frame in request.study.frames]
    known_ms = [time for time in times_ms if time is not None]
    every = fitted_cycle(data / MODEL)
    model = [every[k] for k in spread_out(len(every), wanted)]
    report = runs[processes[0]].report
    return RealCycle(
        environment=where,
        frames=labels,
        times_ms=known_ms if len(known_ms) == len(labels) else None,
        runs=[run_row(count, run) for count, run in runs.items()],
        residuals={s: _residuals(report, labels, s) for s in _SURFACES},
        warm_ml={s: _reported_ml(report, labels, s) for s in _SURFACES},
        cold_ml={s: _fitted_ml(alone, labels, s) for s in _SURFACES},
        model_ml={s: _model_ml(model, s) for s in _SURFACES},
        cold_cpu_s=alone.cpu_s / len(labels),
    )


def guide_point_request(folder: Path, wanted: int | None, options: Options) -> ContourRequest:
    """The guide points of a folder as `neuralmri reconstruct` reads them, three surfaces."""
    files = {path.name: path.read_bytes() for path in sorted(folder.glob("*.txt"))}
    imported = read_guide_points(files, subject_id=folder.name)
    frames = imported.study.frames
    chosen = [frames[k] for k in spread_out(len(frames), wanted)]
    return ContourRequest(
        study=imported.study.model_copy(update={"frames": chosen}),
        options=options.model_copy(update={"surfaces": _SURFACES}),
        warnings=list(imported.warnings),
    )


def run_row(processes: int, run: RealRun) -> RunRow:
    """A run's costs beside what its report says of its stages and frames."""
    report = run.report
    return RunRow(
        processes=processes,
        process_s=run.process_s,
        wall_s=run.costs.wall_s,
        cpu_s=run.costs.cpu_s,
        peak_mib=run.costs.peak_mib,
        stages_s=report.timings_s,
        fit_cpu_s=run.costs.fit_cpu_s,
        from_nothing=[frame.label for frame in report.frames if frame.started_from is None],
        failed=[frame.label for frame in report.failed_frames],
    )


def _residuals(report: Report, labels: Sequence[str], structure: Structure) -> Residuals:
    found = {
        frame.label: frame.surfaces[structure].contour_residual_mm
        for frame in report.frames
        if structure in frame.surfaces
    }
    return Residuals(
        mean_mm=[found[label].mean if label in found else None for label in labels],
        p95_mm=[found[label].p95 if label in found else None for label in labels],
    )


def _reported_ml(report: Report, labels: Sequence[str], structure: Structure) -> Series:
    found = {
        frame.label: frame.surfaces[structure].volume_ml
        for frame in report.frames
        if structure in frame.surfaces
    }
    return [found.get(label) for label in labels]


def _fitted_ml(found: Fitted, labels: Sequence[str], structure: Structure) -> Series:
    meshes = [found.surfaces.get(label, {}).get(structure) for label in labels]
    return [None if mesh is None else volume_ml(mesh) for mesh in meshes]


def _model_ml(frames: Sequence[Mapping[Structure, SurfaceMesh]], structure: Structure) -> Series:
    return [volume_ml(frame[structure]) for frame in frames]
