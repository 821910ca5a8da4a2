"""docs/benchmarks.md: tables and plots of one run, each with how to read it."""

from pathlib import Path
from statistics import median

from benchmarks.holdout_results import HoldoutResults
from benchmarks.methods import BY_NAME, OURS, RIVALS, UNALIGNED
from benchmarks.results import Environment, Results
from benchmarks.tables import comparison, cost, holdout, overview
from benchmarks.tables.case_by_case import case_by_case
from benchmarks.tables.markdown import folded

_TEMPLATE = Path(__file__).with_name("page.md.template")


def page(results: Results, plots: dict[str, str], left_out: HoldoutResults | None = None) -> str:
    """The whole page. plots: by name the file of each plot, as a link from the page. left_out: of
    a run of its own.
    """
    figures = _figures(plots)
    return _TEMPLATE.read_text().format(
        environment=_environment(results.environment),
        methods=overview.methods(results),
        unaligned=BY_NAME[UNALIGNED].label,
        ours=BY_NAME[OURS].label,
        published=BY_NAME[RIVALS[0]].label,
        refined=BY_NAME[RIVALS[1]].label,
        glance=overview.glance(results),
        against_rivals="\n\n".join(_against(results, rival, figures) for rival in RIVALS),
        regions=overview.regions(results),
        shifts=comparison.shifts(results),
        alignment=comparison.alignment(results),
        costs=cost.costs(results),
        speed=cost.speed(results),
        cases=overview.cases(results),
        failures=overview.failures(results),
        case_by_case=case_by_case(results),
        holdout=_holdout(left_out),
        error_plot=figures.get("error", ""),
        time_plot=figures.get("time", ""),
    )


def _against(results: Results, rival: str, figures: dict[str, str]) -> str:
    ours, other = BY_NAME[OURS].label, BY_NAME[rival].label
    parts = [
        f'### "{ours}" against "{other}"',
        f"{other}: {BY_NAME[rival].after}.",
        comparison.against_in_short(results, rival),
        figures.get(f"ratio-{rival}", ""),
        comparison.against(results, rival),
    ]
    return "\n\n".join(part for part in parts if part)


def _holdout(left_out: HoldoutResults | None) -> str:
    if left_out is None:
        return "Not measured in this run."
    times = median(row.times_plain_fit for row in left_out.surfaces)
    cost = f"Leaving out every slice took {times:.1f} times a plain reconstruction (median)."
    rows = folded("Every surface", holdout.by_surface(left_out))
    where = f"Measured, two cases at a time, on: {_environment(left_out.environment)}"
    return "\n\n".join([holdout.in_short(left_out), cost, where, rows])


def _figures(plots: dict[str, str]) -> dict[str, str]:
    captions = {
        "error": "Mean distance by protocol, one factor varied at a time, slices in place or not; "
        "a line that stays low and flat is good.",
        "time": "Time against error: one point a method, medians and geometric means over the "
        "cases in place; down and to the left is good.",
    }
    for rival in RIVALS:
        captions[f"ratio-{rival}"] = (
            f'Every surface of every case, against "{BY_NAME[rival].label}": left of the line the '
            "field is closer."
        )
    return {
        name: f"![{caption}]({plots[name]})\n\n{caption}"
        for name, caption in captions.items()
        if name in plots
    }


def _environment(found: Environment) -> str:
    libraries = ", ".join(f"{name} {version}" for name, version in found.libraries.items())
    return (
        f"{found.cpu}, {found.cores} cores, {found.memory_gib:g} GiB, {found.system}; "
        f"{found.load:g} runnable processes before the run. "
        f"{found.threads} thread a process. Python {found.python}; {libraries}."
    )
