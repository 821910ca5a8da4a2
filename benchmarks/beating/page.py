"""docs/benchmarks/beating.md: what was measured, part by part, with how to read it."""

import re
from collections.abc import Mapping
from pathlib import Path
from statistics import fmean

from benchmarks.beating.phantom_beats import FRAMES
from benchmarks.beating.results import BeatingResults, SlicedCycle
from benchmarks.beating.tables import phantom as phantom_tables
from benchmarks.beating.tables import real as real_tables
from benchmarks.beating.tables import sliced as sliced_tables
from benchmarks.beating.tables.killed import killed as killed_table
from benchmarks.results import Environment

_TEMPLATE = Path(__file__).with_name("page.md.template")
_ABSENT = "Not measured yet."

_OF_THE_CYCLE = 25
"""Frames of the real cycle."""


def page(results: BeatingResults, plots: Mapping[str, str]) -> str:
    """plots: by name the file of each plot, as a link from the page."""
    real, sliced = results.patient1, results.sliced
    phantom, broken = results.phantom, results.killed
    text = _TEMPLATE.read_text().format(
        real_frames=len(real.frames) if real else 0,
        real_short=_short(len(real.frames), _OF_THE_CYCLE) if real else "",
        costs=real_tables.costs(real) if real else _ABSENT,
        cold_cpu_s=f"{real.cold_cpu_s:.1f}" if real else "-",
        pumping=real_tables.pumping(real) if real else _ABSENT,
        volumes_plot=_figure(plots, "volumes", "Volumes by frame, mL."),
        residuals=real_tables.residuals(real) if real else _ABSENT,
        real_where=_where(real.environment) if real else "",
        sliced_frames=sliced.frames if sliced else 0,
        sliced_short=_short(sliced.frames, _OF_THE_CYCLE) if sliced else "",
        sliced=sliced_tables.errors(sliced) if sliced else _ABSENT,
        sliced_costs=_sliced_costs(sliced) if sliced else "",
        distances_plot=_figure(plots, "distances", "Mean distance to the truth by frame, mm."),
        sliced_tracked=sliced_tables.tracked(sliced) if sliced else _ABSENT,
        sliced_where=_where(sliced.environment) if sliced else "",
        phantom_frames=phantom.frames if phantom else 0,
        phantom_short=_short(phantom.frames, FRAMES) if phantom else "",
        phantom_paths=phantom_tables.paths(phantom) if phantom else _ABSENT,
        phantom_volumes=phantom_tables.volumes(phantom) if phantom else _ABSENT,
        phantom_where=_where(phantom.environment) if phantom else "",
        killed=killed_table(broken) if broken else _ABSENT,
        killed_where=_where(broken.environment) if broken else "",
    )
    # What there is nothing to say of leaves no gap.
    return re.sub(r"\n{3,}", "\n\n", text)


def _sliced_costs(found: SlicedCycle) -> str:
    warm, cold = found.warm_cpu_s / found.frames, found.cold_cpu_s / found.frames
    ratio = fmean([fmean(one.warm_mm) / fmean(one.cold_mm) for one in found.surfaces])
    return (
        f"CPU seconds a frame, fit and meshing: {warm:.1f} from neighbours, {cold:.1f} each from "
        f"nothing. Mean distance from neighbours over that from nothing: {ratio:.2f}."
    )


def _short(frames: int, whole: int) -> str:
    """What to say of a run with `--frames`."""
    if frames >= whole:
        return ""
    return (
        f"**A short run: {frames} of {whole} frames.** The heart moves further from frame to frame "
        "than between those of a scanner, so what goes on from a neighbour does worse, and every "
        "curve is jagged; costs are of so many frames."
    )


def _figure(plots: Mapping[str, str], name: str, caption: str) -> str:
    return f"![{caption}]({plots[name]})\n\n{caption}" if name in plots else ""


def _where(found: Environment) -> str:
    libraries = ", ".join(f"{name} {version}" for name, version in found.libraries.items())
    return (
        f"{found.cpu}, {found.cores} cores, {found.memory_gib:g} GiB, {found.system}; "
        f"{found.load:g} runnable processes before the run. "
        f"Python {found.python}; {libraries}."
    )
