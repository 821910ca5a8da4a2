"""A small contour study for the API description: six short-axis slices of an ellipsoid, in mm."""

import math
from typing import Any


def _ring(radius_mm: float, z_mm: float, count: int = 12) -> list[list[float]]:
    angles = (2.0 * math.pi * k / count for k in range(count))
    return [
        [round(radius_mm * math.cos(a), 1), round(radius_mm * math.sin(a), 1), z_mm] for a in angles
    ]


def _slice(number: int) -> dict[str, Any]:
    z_mm = 10.0 * number
    taper = math.sqrt(1.0 - (z_mm / 70.0) ** 2)
    return {
        "id": f"sax-{number:02d}",
        "view": "sax",
        "origin": [0.0, 0.0, z_mm],
        "normal": [0.0, 0.0, 1.0],
        "contours": [
            {"structure": "lv_endo", "closed": True, "points": _ring(25.0 * taper, z_mm)},
            {"structure": "lv_epi", "closed": True, "points": _ring(25.0 * taper + 9.0, z_mm)},
        ],
    }


CONTOUR_REQUEST: dict[str, Any] = {
    "study": {
        "subject_id": "case-01",
        "units": "mm",
        "axes": "LPS",
        "frames": [
            {"label": "ED", "time_ms": 0.0, "slices": [_slice(number) for number in range(6)]}
        ],
    },
    "options": {"preset": "fast", "formats": ["stl"]},
}
