"""The default against a rival, every surface of every case a mark."""

from collections.abc import Callable

from matplotlib.axes import Axes
from matplotlib.figure import Figure

from benchmarks.methods import BY_NAME, OURS
from benchmarks.plots.style import INK, decades, ruled
from benchmarks.results import Results
from benchmarks.summary import Ratio, geometric_mean, ratios
from schemas.vocabulary import Structure

_MARKS = {
    Structure.LV_ENDO: ("#0072B2", "o"),
    Structure.LV_EPI: ("#D55E00", "D"),
    Structure.RV_ENDO: ("#009E73", "^"),
    Structure.RV_EPI: ("#E69F00", "v"),
    Structure.EPI: ("#CC79A7", "s"),
}
_MEASURES: dict[str, Callable[[Ratio], float]] = {
    "mean distance": lambda ratio: ratio.mean,
    "95th percentile": lambda ratio: ratio.p95,
    "maximum": lambda ratio: ratio.maximum,
}


def ratio_by_case(results: Results, rival: str) -> Figure:
    """One panel a measure, one line a case; log scale, dotted the geometric mean in place."""
    found = ratios(results, OURS, rival)
    cases = [case.name for case in results.cases if any(r.case == case.name for r in found)]
    in_place = {case.name for case in results.cases if not case.displaced_rms_mm}
    figure = Figure(figsize=(9.6, 1.6 + 0.26 * len(cases)), layout="constrained")
    panels = figure.subplots(1, len(_MEASURES), sharey=True, sharex=True)
    for axes, (title, measure) in zip(panels, _MEASURES.items(), strict=True):
        typical = geometric_mean(measure(r) for r in found if r.case in in_place)
        _marks(axes, cases, found, measure)
        axes.set_title(f"{title}\nin place {typical:.2f}", loc="left")
        axes.axvline(1.0, color=INK, linewidth=1.0)
        axes.axvline(typical, color=INK, linewidth=1.0, linestyle=":")
        axes.set_xscale("log")
        ruled(axes)
    decades(panels[0].xaxis, *panels[0].get_xlim())
    panels[0].set_yticks(range(len(cases)), cases)
    panels[0].set_ylim(len(cases) - 0.4, -0.6)
    figure.supxlabel(
        f"error of {BY_NAME[OURS].label} / error of {BY_NAME[rival].label}", fontsize=9.0
    )
    handles, labels = panels[0].get_legend_handles_labels()
    figure.legend(handles, labels, loc="outside upper right", ncols=5, frameon=False)
    return figure


def _marks(
    axes: Axes, cases: list[str], found: list[Ratio], measure: Callable[[Ratio], float]
) -> None:
    surfaces = sorted({ratio.surface for ratio in found})
    for rank, surface in enumerate(surfaces):
        colour, marker = _MARKS[surface]
        own = [ratio for ratio in found if ratio.surface == surface]
        # A little apart, so that no mark hides another.
        aside = 0.22 * (rank - (len(surfaces) - 1) / 2.0)
        axes.scatter(
            [measure(ratio) for ratio in own],
            [cases.index(ratio.case) + aside for ratio in own],
            color=colour,
            marker=marker,
            s=24.0,
            label=surface,
            edgecolor="white",
            linewidth=0.5,
            zorder=3,
        )
