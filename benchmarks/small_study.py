"""Two ventricles as ellipsoids, cut by planes: a study as small as one likes."""

import math
from collections.abc import Mapping
from typing import Any

# centre and half-axes, mm: the right ventricle stands beside the left
_ELLIPSOIDS = {
    "lv_endo": ((0.0, 0.0, 0.0), (20.0, 20.0, 40.0)),
    "lv_epi": ((0.0, 0.0, 0.0), (30.0, 30.0, 50.0)),
    "rv_endo": ((-50.0, 0.0, 0.0), (18.0, 25.0, 35.0)),
}
_SHORT_AXIS_MM = (-24.0, -12.0, 0.0, 12.0, 24.0)

QUICK = {
    "preset": "fast",
    "levels": 1,
    "iterations_per_level": 40,
    "mesh": {"grid_mm": 5},
    "formats": ["stl"],
}
"""Options of a fit by the real engine that takes less than a second of a core."""


def small_request(
    name: str, options: Mapping[str, Any], points: int = 40, frames: int = 1
) -> dict[str, Any]:
    """The body of a submission; 1000 contour points are some 60 kB of it.

    points: of each of the 18 contours of a frame.
    """
    slices = [_short_axis(index, z, points) for index, z in enumerate(_SHORT_AXIS_MM)]
    slices.append(_long_axis(points))
    labels = [f"frame-{index:02d}" for index in range(frames)]
    return {
        "study": {
            "subject_id": name,
            "units": "mm",
            "axes": "LPS",
            "frames": [{"label": label, "slices": slices} for label in labels],
        },
        "options": dict(options),
    }


def _ellipse(
    centre: tuple[float, float, float],
    first: tuple[float, float, float],
    second: tuple[float, float, float],
    points: int,
) -> list[list[float]]:
    """The half-axes are `first` and `second`."""
    angles = [2 * math.pi * k / points for k in range(points)]
    axes = list(zip(centre, first, second, strict=True))
    return [[c + a * math.cos(t) + b * math.sin(t) for c, a, b in axes] for t in angles]


def _short_axis(index: int, z: float, points: int) -> dict[str, Any]:
    contours = []
    for structure, ((x, y, _), (a, b, c)) in _ELLIPSOIDS.items():
        scale = math.sqrt(1 - (z / c) ** 2)
        half_axes = (a * scale, 0.0, 0.0), (0.0, b * scale, 0.0)
        contours.append(_contour(structure, _ellipse((x, y, z), *half_axes, points)))
    return {"id": f"sax-{index:02d}", "view": "sax", "contours": contours}


def _long_axis(points: int) -> dict[str, Any]:
    contours = [
        _contour(structure, _ellipse(centre, (a, 0.0, 0.0), (0.0, 0.0, c), points))
        for structure, (centre, (a, _, c)) in _ELLIPSOIDS.items()
    ]
    return {"id": "lax-00", "view": "lax_4ch", "contours": contours}


def _contour(structure: str, points_mm: list[list[float]]) -> dict[str, Any]:
    return {"structure": structure, "closed": True, "points": points_mm}
