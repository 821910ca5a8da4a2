"""A small good study: two ventricles as ellipsoids, cut by short- and long-axis planes. mm, LPS."""

import math
from typing import Any

Json = dict[str, Any]

# centre and half-axes of each ellipsoid, mm: the right ventricle stands beside the left
ELLIPSOIDS = {
    "lv_endo": ((0.0, 0.0, 0.0), (20.0, 20.0, 40.0)),
    "lv_epi": ((0.0, 0.0, 0.0), (30.0, 30.0, 50.0)),
    "rv_endo": ((-50.0, 0.0, 0.0), (18.0, 25.0, 35.0)),
}
SHORT_AXIS_MM = (-24.0, -12.0, 0.0, 12.0, 24.0)
POINTS = 40


def ellipse(centre: tuple[float, ...], first: list[float], second: list[float]) -> list[Any]:
    """POINTS points around `centre`, `first` and `second` being the half-axes."""
    angles = [2 * math.pi * k / POINTS for k in range(POINTS)]
    return [
        [
            c + a * math.cos(t) + b * math.sin(t)
            for c, a, b in zip(centre, first, second, strict=True)
        ]
        for t in angles
    ]


def short_axis_slice(index: int, z: float) -> Json:
    """The plane at height z, mm, across all three ellipsoids."""
    contours = []
    for structure, ((x, y, _), (a, b, c)) in ELLIPSOIDS.items():
        scale = math.sqrt(1 - (z / c) ** 2)
        points = ellipse((x, y, z), [a * scale, 0.0, 0.0], [0.0, b * scale, 0.0])
        contours.append({"structure": structure, "closed": True, "points": points})
    return {
        "id": f"sax-{index:02d}",
        "view": "sax",
        "origin": [0.0, 0.0, z],
        "normal": [0.0, 0.0, 1.0],
        "contours": contours,
        "absent": [],
    }


def long_axis_slice() -> Json:
    """The plane y = 0, through all three ellipsoids' axes."""
    contours = [
        {
            "structure": structure,
            "closed": True,
            "points": ellipse(centre, [a, 0.0, 0.0], [0.0, 0.0, c]),
        }
        for structure, (centre, (a, _, c)) in ELLIPSOIDS.items()
    ]
    return {
        "id": "lax-00",
        "view": "lax_4ch",
        "origin": [0.0, 0.0, 0.0],
        "normal": [0.0, 1.0, 0.0],
        "contours": contours,
        "absent": [],
    }


def good_request() -> Json:
    """A fresh `{"study", "options"}` that every check admits, without a warning."""
    slices = [short_axis_slice(i, z) for i, z in enumerate(SHORT_AXIS_MM)]
    return {
        "study": {
            "subject_id": "ellipsoid",
            "units": "mm",
            "axes": "LPS",
            "frames": [
                {"label": "ED", "time_ms": 0.0, "slices": [*slices, long_axis_slice()]},
            ],
        },
        "options": {},
    }
