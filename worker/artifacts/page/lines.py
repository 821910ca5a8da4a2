"""Numbers over the frames of a cycle, as lines."""

from collections.abc import Mapping, Sequence
from typing import Any

from schemas.cycle_report import Series, SpreadSeries
from schemas.vocabulary import Structure
from worker.artifacts.page.chart import laid_out
from worker.artifacts.page.palette import STRUCTURE_COLOURS

_BAND_OPACITY = 0.18
_DIGITS = 5
"""More tell nothing in a chart."""


def line(name: str, colour: str, at: Sequence[float], values: Series, unit: str) -> dict[str, Any]:
    """A trace of one number a frame."""
    return {
        "type": "scatter",
        "mode": "lines+markers",
        "name": name,
        "x": list(at),
        "y": _rounded(values),
        "line": {"color": colour, "width": 1.8},
        "marker": {"size": 4},
        "hovertemplate": f"%{{y:.4~g}} {unit}<extra>{name}</extra>",
    }


def lines(of: Mapping[Structure, Series], at: Sequence[float], unit: str) -> list[dict[str, Any]]:
    """A trace a surface, in its colour, of those that have a number."""
    return [
        line(structure.value, STRUCTURE_COLOURS[structure], at, values, unit)
        for structure, values in of.items()
        if any(value is not None for value in values)
    ]


def bands(
    of: Mapping[Structure, SpreadSeries], at: Sequence[float], unit: str, *, middle: str
) -> list[dict[str, Any]]:
    """Of each surface a line, of its `mean` or `p50`, in a band from the 5th percentile to the
    95th.
    """
    found = []
    for structure, spread in of.items():
        if not any(value is not None for value in getattr(spread, middle)):
            continue
        colour = STRUCTURE_COLOURS[structure]
        edge = {"type": "scatter", "mode": "lines", "x": list(at), "line": {"width": 0}}
        silent = {"hoverinfo": "skip", "showlegend": False, "legendgroup": structure.value}
        found += [
            edge | silent | {"y": _rounded(spread.p5)},
            edge
            | silent
            | {"y": _rounded(spread.p95), "fill": "tonexty", "fillcolor": _glass(colour)},
            line(structure.value, colour, at, getattr(spread, middle), unit)
            | {"legendgroup": structure.value},
        ]
    return found


def over_time(data: list[dict[str, Any]], across: str, up: str, **layout: Any) -> dict[str, Any]:
    """A figure of such traces."""
    return laid_out(
        data,
        xaxis={"title": {"text": across}},
        yaxis={"title": {"text": up}, "automargin": True},
        hovermode="x unified",
        showlegend=True,
        **layout,
    )


def _rounded(values: Series) -> Series:
    return [None if value is None else float(f"{value:.{_DIGITS}g}") for value in values]


def _glass(colour: str) -> str:
    red, green, blue = (int(colour[k : k + 2], 16) for k in (1, 3, 5))
    return f"rgba({red},{green},{blue},{_BAND_OPACITY})"
