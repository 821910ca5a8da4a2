"""The wall of the left ventricle unrolled: its seventeen segments as rings about the apex."""

from collections.abc import Mapping
from typing import Any

from schemas.frame_report import SegmentReport
from worker.artifacts.page.chart import Chart
from worker.artifacts.page.colour_scales import AMOUNT

_RINGS: Mapping[int, tuple[float, float]] = {
    **dict.fromkeys(range(1, 7), (3.0, 4.0)),
    **dict.fromkeys(range(7, 13), (2.0, 3.0)),
    **dict.fromkeys(range(13, 17), (1.0, 2.0)),
    17: (0.0, 1.0),
}
"""Inner and outer radius of each segment: base outside, apex in the middle."""


def segment_angles_deg(number: int) -> tuple[float, float]:
    """Middle and width of a segment, degrees counter-clockwise from the right (Cerqueira 2002,
    figure 4): the anterior wall is on top, the septum on the left.
    """
    if number == 17:
        return 0.0, 360.0
    if number > 12:
        return 90.0 + 90.0 * (number - 13), 90.0
    return 90.0 + 60.0 * ((number - 1) % 6), 60.0


def thickness_chart(segments: Mapping[int, SegmentReport] | None) -> Chart | None:
    """Mean thickness of every segment, mm, or None where it was not measured."""
    if not segments:
        return None
    said = {
        n: f"{n} {one.name}: {one.mean_mm:.1f} mm ({one.min_mm:.1f} to {one.max_mm:.1f})"
        for n, one in segments.items()
    }
    note = (
        "Mean of each AHA segment, mm; dark is thin. Base outside, apex in the middle, seen from "
        "the apex."
    )
    figure = bullseye({n: one.mean_mm for n, one in segments.items()}, said)
    return Chart("Wall thickness, left ventricle", note, figure)


def bullseye(
    values: Mapping[int, float], said: Mapping[int, str], *, digits: int = 1
) -> dict[str, Any]:
    """A number for every segment, at least one, dark where it is small, and what the mouse reads
    there.
    """
    numbers = [n for n in _RINGS if n in values]
    means = [values[n] for n in numbers]
    angles = [segment_angles_deg(n) for n in numbers]
    rings = [_RINGS[n] for n in numbers]
    low, high = min(means), max(means)
    shades = [[at / (len(AMOUNT) - 1), colour] for at, colour in enumerate(AMOUNT)]
    wedges = {
        "type": "barpolar",
        "theta": [middle for middle, _ in angles],
        "width": [width for _, width in angles],
        "base": [inner for inner, _ in rings],
        "r": [outer - inner for inner, outer in rings],
        "marker": {
            "color": [round(mean, 2) for mean in means],
            "colorscale": shades,
            "cmin": low,
            "cmax": high if high > low else low + 1.0,
            "line": {"color": "white", "width": 1.5},
        },
        "hoverinfo": "text",
        "hovertext": [said[n] for n in numbers],
    }
    labels = {
        "type": "scatterpolar",
        "mode": "text",
        "theta": [middle for middle, _ in angles],
        "r": [
            0.0 if n == 17 else (inner + outer) / 2.0
            for n, (inner, outer) in zip(numbers, rings, strict=True)
        ],
        "text": [f"{mean:.{digits}f}" for mean in means],
        "textfont": {"size": 11, "color": [_ink(mean, low, high) for mean in means]},
        "hoverinfo": "skip",
    }
    return {
        "data": [wedges, labels],
        "layout": {
            "polar": {
                "bgcolor": "rgba(0,0,0,0)",
                "radialaxis": {"visible": False, "range": [0, 4]},
                "angularaxis": {
                    "tickvals": [0, 90, 180, 270],
                    "ticktext": ["lateral", "anterior", "septal", "inferior"],
                    "showgrid": False,
                    "showline": False,
                    "ticks": "",
                },
            },
            "showlegend": False,
            "dragmode": False,
            "margin": {"l": 58, "r": 58, "t": 22, "b": 22},
        },
    }


def _ink(mean: float, low: float, high: float) -> str:
    """Dark on the light end of the colours, light on the dark one."""
    return "#111111" if high > low and (mean - low) / (high - low) > 0.5 else "#ffffff"
