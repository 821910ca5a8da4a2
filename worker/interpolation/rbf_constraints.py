"""What a radial basis function field is told: where, which value, and how faithfully."""

from collections.abc import Callable
from dataclasses import dataclass

import numpy as np
from scipy.interpolate import RBFInterpolator

from worker.arrays import Points, Scalars
from worker.interpolation.contour_samples import ContourSamples

_SAME_MM = 0.01
"""Points nearer than this are one: two equal rows make the system singular."""

Field = Callable[[Points], Scalars]
"""(n, 3) points in mm to (n,) values in mm, positive inside."""


@dataclass(frozen=True, eq=False)
class Constraints:
    """Points (n, 3) mm, their values (n,) mm, and the smoothing (n,) in mm^3 that each may bear."""

    points_mm: Points
    values_mm: Scalars
    smoothing: Scalars

    @staticmethod
    def exact(points_mm: Points, values_mm: Scalars, smoothing: float) -> "Constraints":
        """The same smoothing for all points."""
        return Constraints(points_mm, values_mm, np.full(len(points_mm), smoothing))

    def __add__(self, other: "Constraints") -> "Constraints":
        return Constraints(
            np.concatenate([self.points_mm, other.points_mm]),
            np.concatenate([self.values_mm, other.values_mm]),
            np.concatenate([self.smoothing, other.smoothing]),
        )

    def solved(self, centre_mm: np.ndarray) -> Field:
        """The field of cubic functions and a linear polynomial; of points in one place, the first
        counts. Far from the origin r^3 would lose digits, so it is moved to `centre_mm` (3,).
        """
        centred = self.points_mm - centre_mm
        _, first = np.unique(np.round(centred / _SAME_MM), axis=0, return_index=True)
        chosen = np.sort(first)
        interpolator = RBFInterpolator(
            centred[chosen],
            self.values_mm[chosen],
            kernel="cubic",
            degree=1,
            smoothing=self.smoothing[chosen],
        )

        def field(points_mm: Points) -> Scalars:
            values: Scalars = interpolator(points_mm - centre_mm)
            return values

        return field


def beside_outlines(
    samples: ContourSamples, cosines: Scalars, smoothing: float, extra: float
) -> Constraints:
    """0 on the outlines, and beside them the distance to a surface that leans by `cosines` (n,).

    extra: smoothing that points of short-axis slices bear beyond `smoothing`.
    """
    outer, inner = ~np.isnan(samples.outer_mm), ~np.isnan(samples.inner_mm)
    points = [
        samples.points_mm,
        (samples.points_mm + samples.outer_mm[:, None] * samples.normals)[outer],
        (samples.points_mm - samples.inner_mm[:, None] * samples.normals)[inner],
    ]
    values = [
        np.zeros(len(cosines)),
        -(samples.outer_mm * cosines)[outer],
        (samples.inner_mm * cosines)[inner],
    ]
    borne = np.where(samples.short_axis, smoothing + extra, smoothing)
    return Constraints(
        np.concatenate(points),
        np.concatenate(values),
        np.concatenate([borne, borne[outer], borne[inner]]),
    )
