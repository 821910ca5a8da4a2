"""What accuracy costs: seconds against error, one mark a method."""

from statistics import median

from matplotlib.figure import Figure

from benchmarks.plots.style import LOOKS, decades, ruled
from benchmarks.results import Results
from benchmarks.summary import geometric_mean, of_method, taking_part


def time_and_error(results: Results) -> Figure:
    """Both scales logarithmic; cases whose slices are in place, faint marks single ones."""
    in_place = {case.name for case in results.cases if not case.displaced_rms_mm}
    figure = Figure(figsize=(6.4, 4.2), layout="constrained")
    axes = figure.subplots()
    for method in taking_part(results):
        look = LOOKS[method.name]
        own = [r for r in of_method(results, method.name) if r.case in in_place and r.whole]
        seconds = {r.case: r.wall_s for r in own if r.wall_s is not None}
        errors = {
            case: geometric_mean(r.whole.mean_mm for r in own if r.case == case and r.whole)
            for case in seconds
        }
        if not seconds:
            continue
        axes.scatter(
            list(seconds.values()), list(errors.values()), s=10.0, color=look.colour, alpha=0.35
        )
        axes.scatter(
            median(seconds.values()),
            geometric_mean(errors.values()),
            s=170.0 if look.line == ":" else 90.0,
            marker=look.marker,
            # The unaligned fit takes the time of the aligned one: an open mark shows both.
            facecolor="none" if look.line == ":" else look.colour,
            edgecolor=look.colour if look.line == ":" else "white",
            linewidth=1.6 if look.line == ":" else 0.8,
            label=method.label,
            zorder=3.0 + look.width,
        )
    axes.set(xscale="log", yscale="log", xlabel="wall time, s", ylabel="mean distance, mm")
    decades(axes.xaxis, *axes.get_xlim())
    decades(axes.yaxis, *axes.get_ylim())
    ruled(axes)
    figure.legend(loc="outside right center", frameon=False)
    return figure
