"""Known surfaces, sliced: errors from neighbours beside those from nothing, and tracked meshes."""

from statistics import fmean

from benchmarks.beating.results import SlicedCycle
from benchmarks.beating.tables.tracked import FAULTS, faults
from benchmarks.beating.volume_curve import differences_ml, ef_error_points, known
from benchmarks.tables.markdown import number, table
from worker.evaluation.jitter import jitter


def errors(cycle: SlicedCycle) -> str:
    """Distances, volumes and jitter, warm beside cold."""
    rows = []
    for one in cycle.surfaces:
        for who, mm, ml in (
            ("from neighbours", one.warm_mm, one.warm_ml),
            ("each from nothing", one.cold_mm, one.cold_ml),
        ):
            off_ml = differences_ml(ml, one.true_ml)
            rows.append(
                (
                    f"{one.surface}, {who}",
                    *(number(value, 3) for value in (fmean(mm), max(mm))),
                    number(fmean(known(off_ml)), 2, sign=True),
                    number(jitter(off_ml, is_whole_cycle=True), 2),
                    number(ef_error_points(ml, one.true_ml), 2, sign=True),
                )
            )
    header = (
        *("", "mean distance, mm", "worst frame, mm", "volume error, mL"),
        *("its jitter, mL", "EF error, points"),
    )
    return table(header, rows)


def tracked(cycle: SlicedCycle) -> str:
    """The tracked meshes of the warm run."""
    rows = [
        (
            one.surface,
            number(fmean(one.tracked.to_own_mm), 3),
            number(fmean(one.tracked.from_own_mm), 3),
            number(fmean(one.tracked_mm), 3),
            *faults(one.tracked),
        )
        for one in cycle.surfaces
    ]
    header = ("", "to its own surface, mm", "back, mm", "to the truth, mm", *FAULTS)
    return table(header, rows)
