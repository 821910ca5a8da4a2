"""A real cycle: what a run costs, volumes, and distances from contours."""

from collections.abc import Mapping
from statistics import fmean

from benchmarks.beating.results import RealCycle, RunRow
from benchmarks.beating.volume_curve import known, pump
from benchmarks.tables.markdown import folded, number, table
from schemas.cycle_report import Series
from schemas.vocabulary import Structure
from worker.evaluation.jitter import jitter

_CAVITIES = (Structure.LV_ENDO, Structure.RV_ENDO)


def costs(cycle: RealCycle) -> str:
    """One column a run."""
    stages = dict.fromkeys(stage for run in cycle.runs for stage in run.stages_s)
    rows = [
        ("the process, wall s", *(number(run.process_s, 1) for run in cycle.runs)),
        ("without start and imports, wall s", *(number(run.wall_s, 1) for run in cycle.runs)),
        *(
            (f"{stage}, wall s", *(number(run.stages_s.get(stage), 1) for run in cycle.runs))
            for stage in stages
            if stage != "total"
        ),
        ("CPU s", *(number(run.cpu_s, 1) for run in cycle.runs)),
        ("fit of the first frame, CPU s", *(number(_fit(run, cold=True), 1) for run in cycle.runs)),
        ("fit of another, CPU s", *(number(_fit(run, cold=False), 2) for run in cycle.runs)),
        ("memory at its highest, MiB", *(number(run.peak_mib, 0) for run in cycle.runs)),
        ("frames that failed", *(str(len(run.failed)) for run in cycle.runs)),
    ]
    header = ("", *(f"{run.processes} process{'es' * (run.processes > 1)}" for run in cycle.runs))
    return table(header, rows)


def _fit(run: RunRow, *, cold: bool) -> float | None:
    if run.processes > 1:
        # Whose second it was cannot be told.
        return None
    spent = [s for label, s in run.fit_cpu_s.items() if (label in run.from_nothing) is cold]
    return fmean(spent) if spent else None


def pumping(cycle: RealCycle) -> str:
    """EDV, ESV, EF and jitter of both cavities, by who fitted them."""
    rows = []
    for structure in _CAVITIES:
        for who, volumes in _sources(cycle).items():
            curve = volumes.get(structure, [])
            found = pump(curve)
            if found is None:
                continue
            rows.append(
                (
                    f"{structure}, {who}",
                    number(found.edv_ml, 1),
                    number(found.esv_ml, 1),
                    number(found.ejection_fraction_percent, 1),
                    number(curve[0], 1),
                    number(jitter(curve, is_whole_cycle=True), 2),
                )
            )
    return table(("", "EDV, mL", "ESV, mL", "EF, %", "first frame, mL", "jitter, mL"), rows)


def _sources(cycle: RealCycle) -> Mapping[str, Mapping[Structure, Series]]:
    return {
        "from neighbours (default)": cycle.warm_ml,
        "each from nothing": cycle.cold_ml,
        "model fit by others": cycle.model_ml,
    }


def residuals(cycle: RealCycle) -> str:
    """Over the frames; the frames themselves folded."""
    rows = []
    for structure, found in cycle.residuals.items():
        means, p95s = known(found.mean_mm), known(found.p95_mm)
        if means:
            rows.append(
                (
                    structure,
                    *(number(value, 2) for value in (fmean(means), max(means))),
                    *(number(value, 2) for value in (fmean(p95s), max(p95s))),
                )
            )
    header = ("", "mean, mm", "of the worst frame", "95th percentile, mm", "of the worst frame")
    each = [
        (
            label,
            *(
                f"{number(r.mean_mm[k], 2)} / {number(r.p95_mm[k], 2)}"
                for r in cycle.residuals.values()
            ),
            *(number(volumes[k], 1) for volumes in cycle.warm_ml.values()),
        )
        for k, label in enumerate(cycle.frames)
    ]
    by_frame = (
        "frame",
        *(f"{s}, mm" for s in cycle.residuals),
        *(f"{s}, mL" for s in cycle.warm_ml),
    )
    return "\n\n".join(
        [table(header, rows), folded("Every frame: mean / 95th percentile", table(by_frame, each))]
    )
