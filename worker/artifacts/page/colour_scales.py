"""From numbers to colours: ranges that outliers do not stretch, and grey for what has no number."""

import colorsys
from collections.abc import Sequence
from typing import Any

import numpy as np

from worker.artifacts.page.palette import GREY

ERROR = ("#efece6", "#f3cf9f", "#e58a4c", "#b5332f", "#4d0f26")
"""Pale is good, dark is bad."""

AMOUNT = ("#440154", "#3b528b", "#21918c", "#5ec962", "#fde725")
"""Viridis: neither end is better."""

SIGNED = ("#2b5c9e", "#8fb3d9", "#f2f0ee", "#e0997f", "#a8322a")
"""Blue below zero, red above."""

_GREY_SHARE = 0.06
"""Of the colour bar, at its low end."""


def robust_range(values: np.ndarray, *, kind: Sequence[str]) -> tuple[float, float]:
    """Where colours end, of (n,) numbers or NaN: 0 to the 95th percentile of errors, the 5th to the
    95th of amounts, and of signed numbers as far on either side of 0.
    """
    finite = values[np.isfinite(values)]
    if not len(finite):
        return 0.0, 1.0
    low, high = (float(p) for p in np.percentile(finite, [5.0, 95.0]))
    if kind is SIGNED:
        low, high = -max(-low, high), max(-low, high)
    elif kind is ERROR:
        low = 0.0
    # Everywhere the same, as of a sphere: some range, so that there is a colour at all.
    return (low, high) if high > low else (low - 0.5, low + 0.5)


def scale_of_amounts(
    low: float, high: float, kind: Sequence[str], *, gaps: bool
) -> tuple[dict[str, Any], float]:
    """plotly's colour axis, and the number that stands for NaN: below all others, and grey."""
    first = _GREY_SHARE if gaps else 0.0
    below = low - (high - low) * first / (1.0 - first)
    shades = [
        [first + (1.0 - first) * at, colour]
        for at, colour in zip(np.linspace(0.0, 1.0, len(kind)).tolist(), kind, strict=True)
    ]
    greys = [[0.0, GREY], [first, GREY]] if gaps else []
    # From 1, 2 or 5 times a power of ten to the next: at most seven of them, none in the grey.
    ticks = _round_numbers(low, high)
    bar = {"tickvals": ticks, "ticktext": [f"{tick:.4g}" for tick in ticks]}
    return {"cmin": below, "cmax": high, "colorscale": greys + shades, "colorbar": bar}, below


def scale_of_kinds(names: Sequence[str], colours: Sequence[str]) -> dict[str, Any]:
    """plotly's colour axis of whole numbers from 0 on, each with a colour of its own."""
    steps = []
    for index, colour in enumerate(colours):
        steps += [[index / len(colours), colour], [(index + 1) / len(colours), colour]]
    bar = {"tickvals": list(range(len(names))), "ticktext": list(names), "tickangle": 0}
    return {"cmin": -0.5, "cmax": len(colours) - 0.5, "colorscale": steps, "colorbar": bar}


def segment_colours() -> list[str]:
    """Of AHA segments 0 (grey) to 17: a hue for each direction, the paler the nearer the apex."""
    colours = [GREY]
    for number in range(1, 17):
        ring, wall, walls = (number - 1) // 6, (number - 1) % 6, 6 if number <= 12 else 4
        colours.append(_hex((wall / walls + 0.02) % 1.0, (0.42, 0.58, 0.74)[ring], 0.55))
    return [*colours, _hex(0.0, 0.93, 0.0)]


def _hex(hue: float, lightness: float, saturation: float) -> str:
    red, green, blue = colorsys.hls_to_rgb(hue, lightness, saturation)
    return f"#{round(red * 255):02x}{round(green * 255):02x}{round(blue * 255):02x}"


def _round_numbers(low: float, high: float) -> list[float]:
    power = 10.0 ** np.floor(np.log10((high - low) / 4.0))
    step = next(s * power for s in (1.0, 2.0, 5.0, 10.0) if (high - low) / (s * power) <= 6.0)
    first, last = np.ceil(low / step - 1e-9), np.floor(high / step + 1e-9)
    return [float(round(n * step, 12)) + 0.0 for n in np.arange(first, last + 1.0)]
