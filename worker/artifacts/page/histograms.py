"""How distances are spread."""

from collections.abc import Mapping
from typing import Any

import numpy as np

from schemas.measures import Histogram
from schemas.surface_report import ViewResiduals
from schemas.vocabulary import ViewKind
from worker.arrays import SomeScalars
from worker.artifacts.page.chart import Chart, laid_out
from worker.evaluation.summary import histogram

_VIEWS: Mapping[ViewKind, tuple[str, str]] = {
    "short_axis": ("short axis", "#2c6fb0"),
    "long_axis": ("long axis", "#d98a1c"),
    "other": ("other views", "#8c8c8c"),
}

_SHOWN_PERCENT = 99.5
"""Of the distances; the tail beyond is too thin to see."""


def residual_chart(surface: str, by_view: Mapping[ViewKind, ViewResiduals]) -> Chart | None:
    """Contour residuals of a surface, each kind of view in percent of its own points."""
    if not by_view:
        return None
    bars = [
        _steps(name, colour, by_view[view].histogram)
        for view, (name, colour) in _VIEWS.items()
        if view in by_view
    ]
    end = max(_end_mm(one.histogram) for one in by_view.values())
    return Chart(
        f"Contour residual, {surface}",
        "Distance from contour points to the surface, in percent of each view's points.",
        _figure(bars, end, "contour residual, mm", "points, %"),
    )


def distance_chart(surface: str, distance_mm: SomeScalars) -> Chart:
    """Distances to the reference (n,), mm, of the vertices of a surface, NaN left out."""
    spread = histogram(distance_mm[np.isfinite(distance_mm)])
    return Chart(
        f"Reference distance, {surface}",
        "At the surface's vertices, in percent of them.",
        _figure(
            [_steps("vertices", "#7a4f9a", spread)],
            _end_mm(spread),
            "distance to the reference, mm",
            "vertices, %",
        ),
    )


def _figure(bars: list[dict[str, Any]], end_mm: float, across: str, up: str) -> dict[str, Any]:
    return laid_out(
        bars,
        xaxis={"title": {"text": across}, "range": [0, end_mm]},
        yaxis={"title": {"text": up}, "rangemode": "tozero"},
        showlegend=len(bars) > 1,
    )


def _steps(name: str, colour: str, spread: Histogram) -> dict[str, Any]:
    whole = max(1, sum(spread.counts) + spread.beyond)
    percent = [round(100.0 * count / whole, 3) for count in spread.counts]
    return {
        "type": "scatter",
        "mode": "lines",
        "name": name,
        "x0": 0,
        "dx": spread.bin_width_mm,
        "y": [*percent, 0.0],
        "line": {"shape": "hv", "color": colour, "width": 1.5},
        "fill": "tozeroy",
        "hovertemplate": "from %{x:.1f} mm: %{y:.1f} %<extra>" + name + "</extra>",
    }


def _end_mm(spread: Histogram) -> float:
    """Up to there lie most of the distances; a millimetre at least."""
    reached = np.cumsum(spread.counts)
    whole = reached[-1] + spread.beyond
    bins = int(np.searchsorted(reached, _SHOWN_PERCENT / 100.0 * whole)) + 1
    return float(np.clip(bins, 10, len(reached)) * spread.bin_width_mm)
