"""Who took part, what was reconstructed, and how it went, in one table each."""

import math
from collections.abc import Callable, Sequence
from statistics import fmean, median

from benchmarks.results import Errors, Record, Results
from benchmarks.summary import geometric_mean, groups_of, of_method, taking_part
from benchmarks.tables.markdown import lowest_bold, number, table
from worker.evaluation.thirds import Region

Part = Callable[[Record], Errors | None]


def methods(results: Results) -> str:
    """Who took part."""
    rows = [(m.label, m.after, m.evidence) for m in taking_part(results)]
    return table(("method", "whose", "uses"), rows, aligned_right=False)


def cases(results: Results) -> str:
    """What was reconstructed."""
    rows = [
        (
            case.name,
            str(case.short_axis_slices),
            str(case.long_axis_slices),
            number(case.displaced_rms_mm, 1),
            " / ".join(f"{ml:.0f}" for ml in case.truth_ml.values()),
        )
        for case in results.cases
    ]
    header = ("case", "short-axis slices", "long-axis slices", "displaced by RMS mm", "volumes, mL")
    return table(header, rows)


def glance(results: Results) -> str:
    """One row a method; a pair of columns a group of cases."""
    header, columns = _begun(results)
    for title, names in groups_of(results):
        header += [f"{title}: mean", "95 %"]
        for measure in (_mean, _p95):
            columns.append(
                lowest_bold([_typical(r, names, _whole, measure) for r in _each(results)], 2)
            )
    header += ["wall, s", "failed"]
    columns.append([number(_wall_s(records), 1) for records in _each(results)])
    columns.append([f"{sum(r.whole is None for r in own)}/{len(own)}" for own in _each(results)])
    return table(header, zip(*columns, strict=True))


def regions(results: Results) -> str:
    """One row a method; by thirds, over the cases whose slices are in place."""
    names = {case.name for case in results.cases if not case.displaced_rms_mm}
    header, columns = _begun(results)
    for title, measure in (("mean", _mean), ("95 %", _p95)):
        for region in Region:
            header.append(f"{region}: {title}")
            part = _PARTS[region]
            columns.append(
                lowest_bold([_typical(r, names, part, measure) for r in _each(results)], 2)
            )
    for region in Region:
        header.append(f"{region}: volume, %")
        part = _PARTS[region]
        columns.append(lowest_bold([_volume_off(r, names, part) for r in _each(results)], 1))
    return table(header, zip(*columns, strict=True))


def failures(results: Results) -> str:
    """What failed, and why."""
    rows = [
        (r.case, r.method, r.surface, (r.failure or "").replace("|", "\\|"))
        for r in results.records
        if r.whole is None
    ]
    header = ("case", "method", "surface", "why")
    return table(header, rows, aligned_right=False) if rows else "Nothing failed."


_PARTS: dict[Region, Part] = {
    Region.APEX: lambda record: record.apex,
    Region.MID: lambda record: record.mid,
    Region.BASE: lambda record: record.base,
}


def _whole(record: Record) -> Errors | None:
    return record.whole


def _mean(errors: Errors) -> float:
    return errors.mean_mm


def _p95(errors: Errors) -> float:
    return errors.p95_mm


def _begun(results: Results) -> tuple[list[str], list[Sequence[str]]]:
    return ["method"], [[method.label for method in taking_part(results)]]


def _each(results: Results) -> list[list[Record]]:
    return [of_method(results, method.name) for method in taking_part(results)]


def _typical(
    records: list[Record], cases: set[str], part: Part, measure: Callable[[Errors], float]
) -> float:
    """Geometric mean over the surfaces that there are."""
    found = [errors for r in records if r.case in cases and (errors := part(r))]
    return geometric_mean(measure(errors) for errors in found)


def _volume_off(records: list[Record], cases: set[str], part: Part) -> float:
    """Mean of the volume errors without their signs."""
    found = [errors for r in records if r.case in cases and (errors := part(r))]
    off = [abs(e.volume_error_percent) for e in found if e.volume_error_percent is not None]
    return fmean(off) if off else math.nan


def _wall_s(records: list[Record]) -> float:
    """Median over the cases."""
    by_case = {r.case: r.wall_s for r in records if r.wall_s is not None}
    return median(by_case.values()) if by_case else math.nan
