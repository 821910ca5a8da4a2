"""What the methods took, and how fast the fit is beside its own arithmetic."""

from statistics import median

from benchmarks.results import Record, Results
from benchmarks.summary import of_method, taking_part
from benchmarks.tables.markdown import number, table


def costs(results: Results) -> str:
    """Time and memory of each method: medians over the cases, and the slowest case."""
    header = (
        "method",
        "wall, s",
        "slowest, s",
        "CPU, s",
        "peak, MiB",
        "of it libraries",
        "of it the method",
    )
    rows = []
    for method in taking_part(results):
        by_case = {r.case: r for r in of_method(results, method.name) if r.wall_s is not None}
        rows.append((method.label, *_medians(list(by_case.values()))))
    return table(header, rows)


def speed(results: Results) -> str:
    """The fit beside its products, and subjects a minute; medians."""
    found = results.speed
    if found is None:
        return "Not measured in this run."
    each = [pair.fit_s / pair.products_s for pair in found.pairs]
    alone = median(found.subjects_per_minute_alone)
    together = median(found.subjects_per_minute_together)
    rows = [
        ("matrix products of one fit", f"{found.products}"),
        ("their arithmetic, GFLOP", number(found.gflop, 0)),
        ("the fit, s", number(median(pair.fit_s for pair in found.pairs), 2)),
        ("the products alone, s", number(median(pair.products_s for pair in found.pairs), 2)),
        ("fit / products, pair by pair", ", ".join(number(ratio, 2) for ratio in each)),
        ("**fit / products**", f"**{number(median(each), 2)}**"),
        ("subjects a minute, 1 process", number(alone, 2)),
        (f"**subjects a minute, {found.workers} processes**", f"**{number(together, 2)}**"),
        (
            f"share of {found.workers} times one process",
            f"{100.0 * together / (found.workers * alone):.0f} %",
        ),
    ]
    return table(("standard phantom, standard preset", "median"), rows)


def _medians(records: list[Record]) -> list[str]:
    if not records:
        return ["-"] * 6
    walls = [r.wall_s or 0.0 for r in records]
    peaks = [r.peak_mib or 0.0 for r in records]
    libraries = [r.libraries_mib or 0.0 for r in records]
    own = [peak - loaded for peak, loaded in zip(peaks, libraries, strict=True)]
    return [
        number(median(walls), 1),
        number(max(walls), 1),
        number(median(r.cpu_s or 0.0 for r in records), 1),
        number(median(peaks), 0),
        number(median(libraries), 0),
        number(median(own), 0),
    ]
