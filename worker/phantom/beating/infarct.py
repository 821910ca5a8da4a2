"""A part of the LV wall that does not squeeze: where it is, and how smoothly it begins."""

from dataclasses import dataclass

import numpy as np

from worker.arrays import Scalars
from worker.phantom.beating.smooth_step import smooth_step
from worker.phantom.bounds import require_within


@dataclass(frozen=True)
class Infarct:
    """A window of the wall that does not squeeze; whole within its edges, fading beyond them.

    centre_deg: about the long axis, from the direction to the RV (0) towards the front (90).
    half_width_deg: of the whole part. low, high: its ends along the axis, as rises: 0 at the
    cavity's apex, 1 at its widest section. edge_deg, edge: over which it fades, around and along.
    """

    centre_deg: float = 100.0
    half_width_deg: float = 25.0
    edge_deg: float = 35.0
    low: float = 0.4
    high: float = 0.7
    edge: float = 0.35

    def __post_init__(self) -> None:
        require_within("centre_deg", self.centre_deg, -360.0, 360.0)
        require_within("half_width_deg", self.half_width_deg, 5.0, 80.0)
        require_within("edge_deg", self.edge_deg, 10.0, 80.0)
        require_within("edge", self.edge, 0.1, 0.4)
        require_within("low", self.low, self.edge, 1.0)
        require_within("high", self.high, self.low, 1.0)

    @property
    def extent_rad(self) -> float:
        """`around` integrated over all angles."""
        return float(np.radians(2.0 * self.half_width_deg + self.edge_deg))

    def around(self, angle_rad: Scalars) -> tuple[Scalars, Scalars]:
        """Its share, 0 to 1, at angles about the long axis; with its slope per radian."""
        off = np.mod(angle_rad - np.radians(self.centre_deg) + np.pi, 2.0 * np.pi) - np.pi
        inner = np.radians(self.half_width_deg)
        value, slope = smooth_step(np.abs(off), inner, inner + np.radians(self.edge_deg))
        return 1.0 - value, -np.sign(off) * slope

    def along(self, rise: Scalars) -> tuple[Scalars, Scalars]:
        """Its share, 0 to 1, by rise; with its slope."""
        up, up_slope = smooth_step(rise, self.low - self.edge, self.low)
        down, down_slope = smooth_step(rise, self.high, self.high + self.edge)
        return up - down, up_slope - down_slope
