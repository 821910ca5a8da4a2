"""Which way up a slice is drawn: as seen from the patient's front, or from the feet."""

from dataclasses import dataclass

import numpy as np

from schemas.vocabulary import Axes
from worker.arrays import PlanePoints, Points, Vector

_TO_LEFT = np.array([1.0, 0.0, 0.0])
_TO_BACK = np.array([0.0, 1.0, 0.0])
_TO_HEAD = np.array([0.0, 0.0, 1.0])
_LETTERS = (("L", "R"), ("P", "A"), ("H", "F"))
"""Left and right, posterior and anterior, head and foot: along x, y and z of LPS and against."""

_AXIAL = 0.8
"""Cosine between a slice's normal and the long axis of the body beyond which up is the front."""


@dataclass(frozen=True, eq=False)
class Orientation:
    """Directions (3,), unit, patient axes, that are drawn to the right and upward, and the letters
    of where they point.
    """

    right: Vector
    up: Vector
    right_letters: str
    up_letters: str

    def drawn(self, points_mm: Points) -> PlanePoints:
        """Points (n, 3) as drawn (n, 2), mm: to the right, and downward as in SVG."""
        return np.column_stack([points_mm @ self.right, -(points_mm @ self.up)])


def orientation(normal: Vector, axes: Axes) -> Orientation:
    """Of a slice across `normal` (3,), unit: the head, or of axial slices the front, is up; what is
    on the patient's left is on the right, as radiologists look at it.
    """
    # LPS and RAS are a half-turn about the body's axis from each other.
    lps = np.array([1.0, 1.0, 1.0]) if axes is Axes.LPS else np.array([-1.0, -1.0, 1.0])
    across = normal * lps
    upward = -_TO_BACK if abs(across @ _TO_HEAD) > _AXIAL else _TO_HEAD
    up = upward - across * float(across @ upward)
    up = up / np.linalg.norm(up)
    right = np.cross(up, across)
    # A slice across the body's width has no left: then the back, as seen from the left.
    side = right @ _TO_LEFT
    if side < -1e-6 or (abs(side) <= 1e-6 and right @ _TO_BACK < 0.0):
        right = -right
    return Orientation(right * lps, up * lps, _letters(right), _letters(up))


def _letters(direction: Vector) -> str:
    """Of an LPS direction: where it mostly points, and where else if nearly as much."""
    sizes = np.abs(direction)
    order = np.argsort(-sizes, kind="stable")
    return "".join(_LETTERS[k][int(direction[k] < 0.0)] for k in order if sizes[k] > 0.5)
