"""What is known of slices' shifts, and turns, before any field, and how firmly."""

import math
from dataclasses import dataclass, replace

import numpy as np
from jaxtyping import Bool, Float, Int

TURN_PRIOR = math.radians(5.0)
"""Standard deviation of a slice's turn in its own plane, where slices turn at all."""

_NO_TURN = 1e-4
"""And where they do not, radians."""


@dataclass(frozen=True, eq=False)
class ShiftEvidence:
    """Most probable motion of every slice in its own plane: shift along its two axes, and turn.

    motion: unit lengths, unit lengths, radians right-handed about the slice's pivot. precision: its
    inverse covariance, the prior included. crossings: how many points of long-axis outlines it
    rests on. settled: whether it is known so well that a field has nothing to add. displaced:
    whether slices are to be moved at all. contour_noise: standard deviation of what outlines that
    cross are apart by, beyond the shifts; None where none cross. final: whether the motion was
    found already, and is to be taken as it is.
    """

    motion: Float[np.ndarray, "slices 3"]
    precision: Float[np.ndarray, "slices 3 3"]
    crossings: Int[np.ndarray, " slices"]
    settled: Bool[np.ndarray, " slices"]
    displaced: bool
    contour_noise: float | None = None
    final: bool = False

    def deviations(self) -> Float[np.ndarray, " slices"]:
        """Standard deviation of each shift along its least certain direction, unit lengths.

        NaN where it rests on no crossing.
        """
        return np.where(self.crossings > 0, shift_deviations(self.precision), np.nan)

    def in_place(self, prior: float) -> "ShiftEvidence":
        """The same outlines on slices that may not move: what shifts explained is noise, too."""
        still = no_evidence(len(self.motion), prior)
        if self.contour_noise is None:
            return still
        shifts = self.motion[self.crossings > 0, :2]
        return replace(still, contour_noise=math.hypot(self.contour_noise, _rms(shifts)))


def _rms(shifts: Float[np.ndarray, "k 2"]) -> float:
    """Along each axis."""
    return float(np.sqrt(np.mean(shifts**2)))


def shift_deviations(precision: Float[np.ndarray, "slices 3 3"]) -> Float[np.ndarray, " slices"]:
    """Standard deviation of shifts along their least certain direction."""
    covariance = np.linalg.inv(precision)[:, :2, :2]
    return np.sqrt(np.linalg.eigvalsh(covariance)[:, -1])


def prior_precision(shift: float, turning: bool) -> Float[np.ndarray, "3 3"]:
    """Of a slice's motion, by the standard deviation of its shift along each direction."""
    return np.diag([shift**-2.0, shift**-2.0, (TURN_PRIOR if turning else _NO_TURN) ** -2.0])


def no_evidence(slices: int, prior: float) -> ShiftEvidence:
    """No slice is to move; were it to, by `prior` along each axis (standard deviation)."""
    return ShiftEvidence(
        motion=np.zeros((slices, 3)),
        precision=np.tile(prior_precision(prior, False), (slices, 1, 1)),
        crossings=np.zeros(slices, dtype=np.int64),
        settled=np.zeros(slices, dtype=bool),
        displaced=False,
    )
