"""The affine map that best brings the outlines of one frame onto those of another.

Between neighbours in time a heart shortens, narrows and shifts as a whole: that part of its motion
twelve numbers describe, found from the outlines alone, by closest points (Besl and McKay 1992).
"""

from collections.abc import Mapping
from dataclasses import dataclass

import numpy as np
from jaxtyping import Float
from scipy.spatial import cKDTree

from schemas.vocabulary import Structure
from worker.arrays import Points, SomePoints, Vector

_ROUNDS = 8
"""Closest points are found anew so many times; further rounds move nothing measurably."""

_RIDGE = 1e-3
"""Weight of staying in place, beside the mean square of what is left."""


@dataclass(frozen=True, eq=False)
class AffineMotion:
    """point -> matrix point + offset."""

    matrix: Float[np.ndarray, "3 3"]
    offset: Vector

    def apply(self, points: Points) -> Points:
        """(n, 3) points where they are carried to."""
        return points @ self.matrix.T + self.offset

    def inverse(self) -> "AffineMotion":
        """The way back. Raises LinAlgError for a motion that flattens."""
        back = np.linalg.inv(self.matrix)
        return AffineMotion(back, -back @ self.offset)


STILL = AffineMotion(np.eye(3), np.zeros(3))


def affine_motion(
    before: Mapping[Structure, SomePoints], after: Mapping[Structure, SomePoints]
) -> AffineMotion:
    """From the outline points (n, 3) of one frame to those of another, structure by structure.

    Least squares over closest points, both ways; in place where no structure is in both. Unit
    lengths: the ridge holds what the outlines leave open.
    """
    shared = [structure for structure in before if structure in after]
    trees = {structure: cKDTree(after[structure]) for structure in shared}
    motion = STILL
    for _ in range(_ROUNDS if shared else 0):
        starts, ends = [], []
        for structure in shared:
            points, moved = before[structure], motion.apply(before[structure])
            forth = trees[structure].query(moved)[1]
            back = cKDTree(moved).query(after[structure])[1]
            starts += [points, points[back]]
            ends += [after[structure][forth], after[structure]]
        motion = _least_squares(np.concatenate(starts), np.concatenate(ends))
    return motion


def _least_squares(start: Points, end: Points) -> AffineMotion:
    rows = np.column_stack([start, np.ones(len(start))])
    held = _RIDGE * len(start)
    found = np.linalg.solve(rows.T @ rows + held * np.eye(4), rows.T @ end + held * np.eye(4, 3))
    return AffineMotion(found[:3].T, found[3])
