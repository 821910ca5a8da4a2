"""The LV at end-diastole as radii by height: cavity, outer surface, and where it squeezes."""

from dataclasses import dataclass
from functools import cached_property
from itertools import pairwise

import numpy as np

from worker.arrays import Scalars
from worker.phantom.beating.infarct import Infarct
from worker.phantom.contraction import Layout

_APEX_FADE = 0.12
"""Rise (0 at the cavity's apex, 1 at its widest) at which half of the squeeze is there. Smaller,
and the outer surface has an edge about the apex; larger, and the cavity's tip swells as it
empties."""

_NODES, _WEIGHTS = np.polynomial.legendre.leggauss(48)


@dataclass(frozen=True, eq=False)
class Profile:
    """Squares of radii (mm2) of the LV about its axis, by height in mm; each with its slope (mm).

    layout: the solids at end-diastole, whose ellipsoids are round and centred at height 0.
    """

    layout: Layout
    infarct: Infarct | None = None

    @property
    def base_mm(self) -> float:
        """Height of the base."""
        return self.layout.base_mm

    @property
    def apex_mm(self) -> float:
        """Height of the outer apex."""
        return -self.layout.lv_outer.semi_axes_mm[2]

    def cavity_mm2(self, height_mm: Scalars) -> tuple[Scalars, Scalars]:
        """Square of the cavity's radius; 0 beyond its apex."""
        return _square_radius(self.layout.lv_inner.semi_axes_mm, height_mm)

    def outer_mm2(self, height_mm: Scalars) -> tuple[Scalars, Scalars]:
        """Square of the outer surface's radius; 0 beyond its apex."""
        return _square_radius(self.layout.lv_outer.semi_axes_mm, height_mm)

    def squeeze(self, height_mm: Scalars) -> tuple[Scalars, Scalars]:
        """How much of the squeeze there is, 0 to 1: it fades out at the cavity's apex, below which
        there is no cavity to close.
        """
        depth = self.layout.lv_inner.semi_axes_mm[2]
        rise = np.maximum(height_mm / depth + 1.0, 0.0)
        total = rise**2 + _APEX_FADE**2
        return rise**2 / total, 2.0 * rise * _APEX_FADE**2 / total**2 / depth

    def infarct_along(self, height_mm: Scalars) -> tuple[Scalars, Scalars]:
        """The infarct's share by height."""
        if self.infarct is None:
            return np.zeros_like(height_mm), np.zeros_like(height_mm)
        depth = self.layout.lv_inner.semi_axes_mm[2]
        share, slope = self.infarct.along(height_mm / depth + 1.0)
        return share, slope / depth

    def infarct_around(self, angle_rad: Scalars) -> tuple[Scalars, Scalars]:
        """The infarct's share by angle about the axis."""
        if self.infarct is None:
            return np.zeros_like(angle_rad), np.zeros_like(angle_rad)
        return self.infarct.around(angle_rad)

    @cached_property
    def squeezed_ml(self) -> float:
        """Squeeze times cavity, integrated over it: what a full squeeze of sound wall takes away
        from the cavity.
        """
        return np.pi * self._integral_mm3(infarcted=False) / 1000.0

    @cached_property
    def infarcted_ml(self) -> float:
        """The part of `squeezed_ml` that the infarct has."""
        if self.infarct is None:
            return 0.0
        return self.infarct.extent_rad / 2.0 * self._integral_mm3(infarcted=True) / 1000.0

    def _integral_mm3(self, *, infarcted: bool) -> float:
        """Over height, by Gauss-Legendre between the places where the integrand is not smooth."""
        depth = self.layout.lv_inner.semi_axes_mm[2]
        breaks = [-depth, self.base_mm]
        if self.infarct is not None:
            low, high, edge = self.infarct.low, self.infarct.high, self.infarct.edge
            rises = np.array([low - edge, low, high, high + edge])
            breaks += [*np.clip((rises - 1.0) * depth, -depth, self.base_mm)]
        total = 0.0
        for start, end in pairwise(sorted(breaks)):
            height = (start + end + (end - start) * _NODES) / 2.0
            value = self.squeeze(height)[0] * self.cavity_mm2(height)[0]
            if infarcted:
                value = value * self.infarct_along(height)[0]
            total += float((end - start) / 2.0 * (_WEIGHTS @ value))
        return total


def _square_radius(
    semi_axes_mm: tuple[float, float, float], height_mm: Scalars
) -> tuple[Scalars, Scalars]:
    radius, _, depth = semi_axes_mm
    square = radius**2 * (1.0 - (height_mm / depth) ** 2)
    inside = square > 0.0
    slope = np.where(inside, -2.0 * radius**2 * height_mm / depth**2, 0.0)
    return np.where(inside, square, 0.0), slope
