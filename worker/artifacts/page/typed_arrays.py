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


def coordinates(points: np.ndarray) -> dict[str, Any]:
    """x, y and z of points (n, 3), mm, to a hundredth: what is drawn needs no more."""
    x, y, z = np.round(points, 2).T
    return {"x": typed(x), "y": typed(y), "z": typed(z)}
