"""Where every point of the heart goes, in closed form, and back.

In cylindrical coordinates about the LV's axis a point (R, angle, Z) of end-diastole is carried to

    z = apex + stretch (Z - apex),   angle + turn(Z),   r^2 = grow R^2 - shed,

grow and shed being functions of Z and the angle, other ones in each of three regions:

- the wall: grow = 1 / stretch, shed = c. Whatever c, the determinant of the deformation gradient
  is (grow R / r) (r / R) stretch = 1: the wall is incompressible point by point. c is the squeeze
  times the cavity's squared radius.
- the cavity, which is no material but has a lid: grow = r^2 / R^2 of the wall's inner surface, so
  it shrinks towards the axis.
- what lies outside, where the RV is: grow = rv_share / stretch, and shed such that the LV's outer
  surface moves with the wall. The determinant is rv_share everywhere, so the RV's volume has that
  share; and what was outside of the LV stays outside.

The three agree on the surfaces between them. All points here are in the heart's own frame, mm.
"""

from dataclasses import dataclass

import numpy as np
from jaxtyping import Float

from worker.arrays import Points, Scalars
from worker.phantom.beating.beat import APEX_SHARE
from worker.phantom.beating.instant import Instant
from worker.phantom.beating.profile import Profile

Gradients = Float[np.ndarray, "n 3 3"]
"""A deformation gradient at each of as many points."""

_ON_SURFACE_MM = 0.002
"""So near to a surface of the LV a point belongs to its wall."""


@dataclass(frozen=True, eq=False)
class _Law:
    """r^2 = grow R^2 - shed, and the slopes of both by height (_z, per mm) and angle (_t)."""

    grow: Scalars
    grow_z: Scalars
    grow_t: Scalars
    shed: Scalars
    shed_z: Scalars
    shed_t: Scalars

    def hoop(self, radius_mm: Scalars) -> Scalars:
        """r / R, its limit on the axis."""
        return np.sqrt(np.maximum(self.grow - _over(self.shed, radius_mm**2), 0.0))


def carried(profile: Profile, instant: Instant, points_mm: Points) -> Points:
    """Points (n, 3) of end-diastole at the instant."""
    height = points_mm[:, 2]
    radius = np.hypot(points_mm[:, 0], points_mm[:, 1])
    law = _law(profile, instant, points_mm)
    hoop = law.hoop(radius)
    turn, _ = _turn(profile, instant, height)
    cos, sin = hoop * np.cos(turn), hoop * np.sin(turn)
    x, y = points_mm[:, 0], points_mm[:, 1]
    at = profile.apex_mm + instant.stretch * (height - profile.apex_mm)
    return np.column_stack([cos * x - sin * y, sin * x + cos * y, at])


def carried_back(profile: Profile, instant: Instant, points_mm: Points) -> Points:
    """Where points (n, 3) of the instant are at end-diastole: the inverse of `carried`."""
    height = profile.apex_mm + (points_mm[:, 2] - profile.apex_mm) / instant.stretch
    turn, _ = _turn(profile, instant, height)
    cos, sin = np.cos(turn), np.sin(turn)
    x, y = points_mm[:, 0], points_mm[:, 1]
    turned = np.column_stack([cos * x + sin * y, cos * y - sin * x, height])
    square = x**2 + y**2
    cavity, wall, outside = _laws(profile, instant, turned)
    # Of which region a point is, its radius tells: the laws agree at the surfaces.
    inner, outer = profile.cavity_mm2(height)[0], profile.outer_mm2(height)[0]
    inner_now = wall.grow * inner - wall.shed
    outer_now = wall.grow * outer - wall.shed
    in_cavity, in_wall = square < inner_now, square < outer_now
    before = [(square + law.shed) / law.grow for law in (cavity, wall, outside)]
    was = np.select([in_cavity, in_wall], before[:2], before[2])
    back = np.sqrt(np.maximum(_over(was, square), 0.0))
    return turned * np.column_stack([back, back, np.ones_like(back)])


def deformation_gradients(profile: Profile, instant: Instant, points_mm: Points) -> Gradients:
    """d carried / d point at points (n, 3) of end-diastole. In the wall its determinant is 1."""
    radius = np.hypot(points_mm[:, 0], points_mm[:, 1])
    angle = np.arctan2(points_mm[:, 1], points_mm[:, 0])
    turn, turn_slope = _turn(profile, instant, points_mm[:, 2])
    law = _law(profile, instant, points_mm)
    hoop = law.hoop(radius)
    polar = np.zeros((len(points_mm), 3, 3))
    polar[:, 0, 0] = law.grow / hoop
    polar[:, 0, 1] = (law.grow_t - _over(law.shed_t, radius**2)) / (2.0 * hoop)
    polar[:, 0, 2] = (law.grow_z * radius - _over(law.shed_z, radius)) / (2.0 * hoop)
    polar[:, 1, 1] = hoop
    polar[:, 1, 2] = hoop * radius * turn_slope
    polar[:, 2, 2] = instant.stretch
    return np.einsum("nij,njk,nlk->nil", _polar_axes(angle + turn), polar, _polar_axes(angle))


def _turn(profile: Profile, instant: Instant, height_mm: Scalars) -> tuple[Scalars, Scalars]:
    """Turn about the axis (from the RV towards the front), linear in height; and its slope.

    Counter-clockwise seen from the apex is negative about an axis that points to the base.
    """
    length = profile.base_mm - profile.apex_mm
    share = (height_mm - profile.apex_mm) / length
    turn = -instant.twist_rad * (APEX_SHARE - share)
    return turn, np.full_like(turn, instant.twist_rad / length)


def _law(profile: Profile, instant: Instant, points_mm: Points) -> _Law:
    """Each point's own law."""
    cavity, wall, outside = _laws(profile, instant, points_mm)
    radius = np.hypot(points_mm[:, 0], points_mm[:, 1])
    inner = np.sqrt(profile.cavity_mm2(points_mm[:, 2])[0])
    outer = np.sqrt(profile.outer_mm2(points_mm[:, 2])[0])
    is_cavity, is_wall = radius < inner - _ON_SURFACE_MM, radius < outer + _ON_SURFACE_MM

    def chosen(name: str) -> Scalars:
        options = [getattr(law, name) for law in (cavity, wall)]
        return np.select([is_cavity, is_wall], options, getattr(outside, name))

    return _Law(*(chosen(name) for name in _Law.__dataclass_fields__))


def _laws(profile: Profile, instant: Instant, points_mm: Points) -> tuple[_Law, _Law, _Law]:
    """Laws of cavity, wall and outside at the points' heights and angles."""
    height = points_mm[:, 2]
    angle = np.arctan2(points_mm[:, 1], points_mm[:, 0])
    fade, fade_z = profile.squeeze(height)
    along, along_z = profile.infarct_along(height)
    around, around_t = profile.infarct_around(angle)
    less = instant.squeeze - instant.infarct_squeeze
    strength = instant.squeeze - less * along * around
    squeeze = fade * strength
    squeeze_z = fade_z * strength - fade * less * along_z * around
    squeeze_t = -fade * less * along * around_t

    inner, inner_z = profile.cavity_mm2(height)
    outer, outer_z = profile.outer_mm2(height)
    none = np.zeros_like(height)
    grow = np.full_like(height, 1.0 / instant.stretch)
    shed, shed_t = squeeze * inner, squeeze_t * inner
    shed_z = squeeze_z * inner + squeeze * inner_z
    drawn = (1.0 - instant.rv_share) / instant.stretch
    return (
        _Law(grow - squeeze, -squeeze_z, -squeeze_t, none, none, none),
        _Law(grow, none, none, shed, shed_z, shed_t),
        _Law(
            *(instant.rv_share * grow, none, none),
            *(shed - drawn * outer, shed_z - drawn * outer_z, shed_t),
        ),
    )


def _over(value: Scalars, by: Scalars) -> Scalars:
    """value / by, and 0 on the axis, where no `value` here is anything else."""
    return np.divide(value, by, out=np.zeros_like(value), where=by > 0.0)


def _polar_axes(angle_rad: Scalars) -> Gradients:
    """Columns: unit vectors away from the axis, around it, and along it."""
    axes = np.zeros((len(angle_rad), 3, 3))
    axes[:, 0, 0] = axes[:, 1, 1] = np.cos(angle_rad)
    axes[:, 1, 0] = np.sin(angle_rad)
    axes[:, 0, 1] = -axes[:, 1, 0]
    axes[:, 2, 2] = 1.0
    return axes
