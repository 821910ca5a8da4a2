"""Plots of a run as files."""

from pathlib import Path

from matplotlib import rc_context

from benchmarks.methods import OURS, RIVALS
from benchmarks.plots.error_by_protocol import error_by_protocol
from benchmarks.plots.ratios import ratio_by_case
from benchmarks.plots.style import SETTINGS
from benchmarks.plots.time_and_error import time_and_error
from benchmarks.results import Results
from benchmarks.summary import ratios


def draw(results: Results, folder: Path) -> dict[str, Path]:
    """Every plot that a run has the numbers for, by name, as an SVG file in `folder`."""
    files = {}
    with rc_context(SETTINGS):
        figures = {}
        if any(record.whole for record in results.records):
            figures["time"] = time_and_error(results)
        if any(case.factors for case in results.cases):
            figures["error"] = error_by_protocol(results)
        for rival in RIVALS:
            if ratios(results, OURS, rival):
                figures[f"ratio-{rival}"] = ratio_by_case(results, rival)
        for name, figure in figures.items():
            files[name] = folder / f"{name}.svg"
            figure.savefig(files[name], metadata={"Date": None})
    return files
