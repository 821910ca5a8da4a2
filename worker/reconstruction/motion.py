"""How slices were found displaced: rigid motions in their own planes."""

from dataclasses import dataclass

import numpy as np
from jaxtyping import Float

from worker.arrays import Points, SomePoints, Vector


@dataclass(frozen=True, eq=False)
class SliceMotion:
    """A shift (slices, 3) and a turn (slices,) in radians about each slice's normal at its pivot.

    One length unit throughout. Contours as drawn are the heart's, shifted and then turned about the
    pivot, which is their own middle.
    """

    shifts: Float[np.ndarray, "slices 3"]
    turns: Float[np.ndarray, " slices"]
    pivots: Float[np.ndarray, "slices 3"]


def moved_back(
    points: SomePoints, shift: Vector, turn: float, pivot: Vector, normal: Vector
) -> Points:
    """Points (n, 3) of a slice where the heart is: turned back by `turn`, then shifted back."""
    if turn == 0.0:
        return points - shift
    across = np.cross(normal, points - pivot)
    turned = points - np.sin(turn) * across + (1.0 - np.cos(turn)) * np.cross(normal, across)
    back: Points = turned - shift
    return back
