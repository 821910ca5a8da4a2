"""Error against each factor of the protocol, a line a method."""

from matplotlib.figure import Figure

from benchmarks.cases import FACTORS, STANDARD, factors
from benchmarks.plots.style import LOOKS, decades, ruled
from benchmarks.results import Results
from benchmarks.summary import geometric_mean, of_method, taking_part

_LABELS = {
    "spacing_mm": "slice gap, mm",
    "long_axis_planes": "long-axis slices",
    "shift_sd_mm": "displacement, SD mm",
    "noise_sd_mm": "contour noise, SD mm",
}


def error_by_protocol(results: Results) -> Figure:
    """One panel a factor; geometric mean over surfaces of the mean distance, mm, log scale."""
    figure = Figure(figsize=(9.6, 4.0), layout="constrained")
    panels = figure.subplots(1, len(FACTORS), sharey=True)
    for axes, factor in zip(panels, FACTORS, strict=True):
        for method in taking_part(results):
            look = LOOKS[method.name]
            found = along(results, method.name, factor)
            axes.plot(
                list(found),
                list(found.values()),
                label=method.label,
                color=look.colour,
                marker=look.marker,
                linestyle=look.line,
                linewidth=look.width,
                markersize=5.5,
                markeredgecolor="white",
                markeredgewidth=0.6,
                zorder=2.0 + look.width,
            )
        axes.set_xlabel(_LABELS[factor])
        axes.set_xticks(FACTORS[factor])
        ruled(axes)
    panels[0].set_yscale("log")
    decades(panels[0].yaxis, *panels[0].get_ylim())
    panels[0].set_ylabel("mean distance, mm")
    handles, labels = panels[0].get_legend_handles_labels()
    figure.legend(handles, labels, loc="outside lower center", ncols=5, frameon=False)
    return figure


def along(results: Results, method: str, factor: str) -> dict[float, float]:
    """Error of a method by value of one factor, where all others are the standard's."""
    standard = factors(STANDARD)
    found = {}
    for case in results.cases:
        others = {**case.factors, factor: standard[factor]}
        if not case.factors or others != standard:
            continue
        surfaces = [r.whole for r in of_method(results, method) if r.case == case.name and r.whole]
        if surfaces:
            found[case.factors[factor]] = geometric_mean(e.mean_mm for e in surfaces)
    return dict(sorted(found.items()))
