"""Every number of every case."""

from benchmarks.methods import BY_NAME
from benchmarks.results import Errors, Record, Results
from benchmarks.tables.markdown import folded, number, table

_PARTS = ("apex", "mid", "base")


def case_by_case(results: Results) -> str:
    """A heading, a table, and a folded table by region for each case."""
    sections = []
    for case in results.cases:
        records = [r for r in results.records if r.case == case.name]
        sections.append(
            f"### {case.name}\n\n{_whole(records)}\n\n"
            + folded("by region: apex, mid, base", _by_region(records))
        )
    return "\n\n".join(sections)


def _whole(records: list[Record]) -> str:
    surfaces = list(dict.fromkeys(r.surface for r in records))
    by_method: dict[str, dict[str, Record]] = {}
    for record in records:
        by_method.setdefault(record.method, {})[record.surface] = record
    rows = []
    for method, of_surface in by_method.items():
        any_ = next(iter(of_surface.values()))
        cells = [_cell(of_surface[surface].whole) for surface in surfaces]
        rows.append((BY_NAME[method].label, *cells, number(any_.wall_s, 1)))
    return table(("method", *surfaces, "wall, s"), rows)


def _by_region(records: list[Record]) -> str:
    rows = [
        (r.surface, BY_NAME[r.method].label, *(_cell(getattr(r, part)) for part in _PARTS))
        for r in sorted(records, key=lambda r: r.surface)
    ]
    return table(("surface", "method", *_PARTS), rows)


def _cell(errors: Errors | None) -> str:
    if errors is None:
        return "failed"
    distances = (number(v, 2) for v in (errors.mean_mm, errors.rms_mm, errors.p95_mm))
    volume = number(errors.volume_error_percent, 1, sign=True)
    return " / ".join([*distances, number(errors.max_mm, 1), volume])
