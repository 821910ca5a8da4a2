"""Arrays as plotly.js reads them out of JSON: little-endian bytes in base64."""

import base64
from collections.abc import Sequence
from typing import Any, Literal

import numpy as np

Form = Literal["f4", "u1", "u2", "u4"]


def typed(values: np.ndarray | Sequence[float], form: Form = "f4") -> dict[str, str]:
    """`{"dtype": ..., "bdata": ...}`: a third of the digits' size, and read without parsing.

    values: (n,) numbers that the form can hold; NaN is a gap.
    """
    packed = np.ascontiguousarray(values).astype(f"<{form}")
    return {"dtype": form, "bdata": base64.b64encode(packed.tobytes()).decode("ascii")}


def index_form(count: int) -> Form:
    """The smallest form of indices into so many."""
    return "u2" if count <= 2**16 else "u4"


def corners(faces: np.ndarray) -> dict[str, Any]:
    """i, j and k of triangles (m, 3): which vertices they join."""
    form = index_form(int(faces.max()) + 1 if len(faces) else 0)
    first, second, third = faces.T
    return {"i": typed(first, form), "j": typed(second, form), "k": typed(third, form)}


def coordinates(points: np.ndarray) -> dict[str, Any]:
    """x, y and z of points (n, 3), mm, to a hundredth: what is drawn needs no more."""
    x, y, z = np.round(points, 2).T
    return {"x": typed(x), "y": typed(y), "z": typed(z)}


def stepped(values: np.ndarray) -> dict[str, Any]:
    """Numbers of any shape in two bytes each: the least, `origin`, and how many a `step` above it;
    to half a step, a 131 070th of their range. Not plotly's: the page's own script reads them.
    """
    origin = float(values.min())
    step = (float(values.max()) - origin) / 65535.0 or 1.0
    return {
        "origin": origin,
        "step": step,
        **typed(np.rint((values.ravel() - origin) / step), "u2"),
    }
