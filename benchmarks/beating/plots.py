"""Plots of a cycle as files: volumes by frame, and distances to the truth by frame."""

from collections.abc import Sequence
from pathlib import Path

import numpy as np
from matplotlib import rc_context
from matplotlib.axes import Axes
from matplotlib.figure import Figure
from matplotlib.ticker import MaxNLocator

from benchmarks.beating.results import BeatingResults, RealCycle, SlicedCycle
from benchmarks.plots.style import LOOKS, SETTINGS, Look, ruled
from schemas.cycle_report import Series

_WARM, _COLD, _MODEL = LOOKS["field-standard"], LOOKS["hermite-rbf"], LOOKS["morphological"]


def draw(results: BeatingResults, folder: Path) -> dict[str, Path]:
    """Every plot that there are numbers for, by name, as an SVG file in `folder`."""
    files = {}
    with rc_context(SETTINGS):
        figures = {}
        if results.patient1:
            figures["volumes"] = volumes(results.patient1)
        if results.sliced:
            figures["distances"] = distances(results.sliced)
        for name, figure in figures.items():
            files[name] = folder / f"beating-{name}.svg"
            figure.savefig(files[name], metadata={"Date": None})
    return files


def volumes(cycle: RealCycle) -> Figure:
    """A panel a surface."""
    figure = Figure(figsize=(9.6, 3.4), layout="constrained")
    panels = figure.subplots(1, len(cycle.warm_ml))
    for axes, structure in zip(np.atleast_1d(panels), cycle.warm_ml, strict=True):
        _line(axes, cycle.model_ml[structure], _MODEL, "model fit by others")
        _line(axes, cycle.cold_ml[structure], _COLD, "each from nothing")
        _line(axes, cycle.warm_ml[structure], _WARM, "from neighbours (default)")
        axes.set(title=structure, xlabel="frame")
        ruled(axes)
    np.atleast_1d(panels)[0].set_ylabel("volume, mL")
    _legend(figure, np.atleast_1d(panels)[0])
    return figure


def distances(cycle: SlicedCycle) -> Figure:
    """A panel a surface."""
    figure = Figure(figsize=(9.6, 3.4), layout="constrained")
    panels = np.atleast_1d(figure.subplots(1, len(cycle.surfaces), sharey=True))
    for axes, surface in zip(panels, cycle.surfaces, strict=True):
        _line(axes, surface.cold_mm, _COLD, "each from nothing")
        _line(axes, surface.warm_mm, _WARM, "from neighbours (default)")
        _line(axes, surface.tracked_mm, LOOKS["shape-linear"], "tracked mesh")
        axes.set(title=surface.surface, xlabel="frame")
        axes.set_ylim(bottom=0.0)
        ruled(axes)
    panels[0].set_ylabel("mean distance to the truth, mm")
    _legend(figure, panels[0])
    return figure


def _line(axes: Axes, values: Series | Sequence[float], look: Look, label: str) -> None:
    axes.plot(
        range(len(values)),
        [float("nan") if value is None else value for value in values],
        color=look.colour,
        marker=look.marker,
        linewidth=look.width,
        markersize=4.0,
        label=label,
    )
    axes.xaxis.set_major_locator(MaxNLocator(integer=True))


def _legend(figure: Figure, axes: Axes) -> None:
    figure.legend(*axes.get_legend_handles_labels(), loc="outside lower center", ncols=3)
