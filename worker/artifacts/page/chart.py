"""A chart of the page: what plotly draws, and the words around it."""

from dataclasses import dataclass
from typing import Any


@dataclass(frozen=True)
class Chart:
    """title: its heading. note: what there is to know about it. figure: plotly's data, layout.
    broad: twice as wide as others, where there is room.
    """

    title: str
    note: str
    figure: dict[str, Any]
    broad: bool = False


def laid_out(data: list[dict[str, Any]], **layout: Any) -> dict[str, Any]:
    """A figure without a title of its own, its legend above the plot."""
    return {
        "data": data,
        "layout": {
            "margin": {"l": 48, "r": 8, "t": 8, "b": 40},
            "legend": {"orientation": "h", "x": 0, "y": 1, "yanchor": "bottom"},
            "hovermode": "closest",
            # A finger that drags is to scroll the page, not to zoom into the chart.
            "dragmode": False,
            **layout,
        },
    }
