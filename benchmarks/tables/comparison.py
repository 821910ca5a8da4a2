"""Two methods against each other: the default against a rival, aligned against unaligned."""

from collections.abc import Iterable, Sequence

from benchmarks.methods import OURS, UNALIGNED
from benchmarks.results import Results
from benchmarks.summary import (
    Ratio,
    geometric_mean,
    groups_of,
    of_method,
    ratios,
    taking_part,
)
from benchmarks.tables.markdown import number, table


def against(results: Results, rival: str) -> str:
    """The default preset over the rival, one row a case."""
    found = ratios(results, OURS, rival)
    surfaces = list(dict.fromkeys(ratio.surface for ratio in found))
    cells = {
        (r.case, r.surface): " / ".join(number(v, 2) for v in (r.mean, r.p95, r.maximum))
        for r in found
    }
    rows = [
        (case.name, *(cells.get((case.name, surface), "-") for surface in surfaces))
        for case in results.cases
    ]
    return table(("case", *surfaces), rows)


def against_in_short(results: Results, rival: str) -> str:
    """Geometric means and worst of these ratios, by group and over all."""
    found = ratios(results, OURS, rival)
    every = ("all", {case.name for case in results.cases})
    rows = [
        _in_short(title, [r for r in found if r.case in names])
        for title, names in [*groups_of(results), every]
    ]
    header = (
        "cases",
        "surfaces",
        "closer in",
        "mean",
        "95 %",
        "maximum",
        "worst mean",
        "worst 95 %",
        "worst maximum",
    )
    return table(header, rows)


def shifts(results: Results) -> str:
    """What is left of the displacements, for methods that look for them."""
    looking = [
        method
        for method in taking_part(results)
        if any(r.shift_rms_mm is not None for r in of_method(results, method.name))
    ]
    rows = []
    for case in results.cases:
        left = {r.method: r.shift_rms_mm for r in results.records if r.case == case.name}
        after = (number(left.get(method.name), 2) for method in looking)
        rows.append((case.name, number(case.displaced_rms_mm, 2), *after))
    return table(("case", "before", *(f"after: {method.label}" for method in looking)), rows)


def alignment(results: Results) -> str:
    """Mean distance with alignment over that without, per cent more or less."""
    found = ratios(results, OURS, UNALIGNED)
    surfaces = list(dict.fromkeys(ratio.surface for ratio in found))

    def row(title: str, cases: Iterable[str]) -> tuple[str, ...]:
        chosen = [r for r in found if r.case in set(cases)]
        means = [geometric_mean(r.mean for r in chosen if r.surface == s) for s in surfaces]
        means.append(geometric_mean(r.mean for r in chosen))
        return (title, *(number(100.0 * (mean - 1.0), 1, sign=True) for mean in means))

    rows = [row(case.name, [case.name]) for case in results.cases]
    rows += [row(f"**{title}**", names) for title, names in groups_of(results)]
    return table(("case", *surfaces, "all surfaces"), rows)


def _in_short(title: str, found: Sequence[Ratio]) -> tuple[str, ...]:
    if not found:
        return (title, "0", *["-"] * 7)
    columns = [[r.mean for r in found], [r.p95 for r in found], [r.maximum for r in found]]
    return (
        title,
        str(len(found)),
        str(sum(r.mean < 1.0 for r in found)),
        *(f"**{number(geometric_mean(column), 2)}**" for column in columns),
        *(number(max(column), 2) for column in columns),
    )
