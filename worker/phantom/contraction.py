"""How a heart of a given shape is laid out at a phase of systole."""

from dataclasses import dataclass

from scipy.optimize import brentq

from worker.phantom.ellipsoid import Ellipsoid
from worker.phantom.shape import HeartShape


@dataclass(frozen=True)
class Layout:
    """The solids of one instant, in the heart's own frame: z from apex to base, x from LV to RV.

    base_mm: height of the flat base that cuts all of them.
    """

    lv_inner: Ellipsoid
    lv_outer: Ellipsoid
    rv: Ellipsoid
    base_mm: float


def layout(shape: HeartShape, phase: float) -> Layout:
    """The solids at `phase` (0 end-diastole, 1 end-systole).

    The LV cavity shrinks, its wall thickens so that its volume stays the same, the outer apex
    stays in place and the base comes down to it, as in a beating heart.
    """
    shorter = 1.0 - shape.longitudinal_shortening * phase
    radius = shape.lv_radius_mm * (1.0 - shape.radial_shortening * phase)
    depth, height = shape.lv_apex_depth_mm * shorter, shape.base_height_mm * shorter
    at_rest = _muscle_ml(
        shape, shape.lv_radius_mm, shape.lv_apex_depth_mm, shape.base_height_mm, shape.wall_mm
    )
    wall = brentq(
        lambda w: _muscle_ml(shape, radius, depth, height, w) - at_rest, shape.wall_mm / 2, 100.0
    )
    level = (
        depth + shape.apex_wall_ratio * (wall - shape.wall_mm) - shape.lv_apex_depth_mm
    )  # of the widest section; 0 at end-diastole
    inner, outer = _nested(shape, radius, depth, wall, level)
    return Layout(inner, outer, _rv(shape, phase, outer), level + height)


def _nested(
    shape: HeartShape, radius: float, depth: float, wall: float, level: float
) -> tuple[Ellipsoid, Ellipsoid]:
    """LV cavity and LV outer surface, centred at height `level`."""
    centre = (0.0, 0.0, level)
    outer = radius + wall
    return (
        Ellipsoid(centre, (radius, radius, depth)),
        Ellipsoid(centre, (outer, outer, depth + shape.apex_wall_ratio * wall)),
    )


def _muscle_ml(shape: HeartShape, radius: float, depth: float, height: float, wall: float) -> float:
    inner, outer = _nested(shape, radius, depth, wall, 0.0)
    return outer.volume_below_ml(height) - inner.volume_below_ml(height)


def _rv(shape: HeartShape, phase: float, lv_outer: Ellipsoid) -> Ellipsoid:
    """The ellipsoid of which the RV cavity is what the LV leaves free.

    Its centre lies a little in front, so that the phantom has no plane of symmetry: a mirrored
    reconstruction cannot pass for the right one.
    """
    radius, _, depth = lv_outer.semi_axes_mm
    reach = shape.rv_reach_mm * (1.0 - shape.rv_shortening * phase)
    offset = 0.72 * radius
    return Ellipsoid(
        centre_mm=(offset, 0.1 * radius, lv_outer.centre_mm[2]),
        semi_axes_mm=(
            radius + shape.rv_gap_mm + reach - offset,
            shape.rv_breadth_ratio * radius,
            shape.rv_depth_ratio * depth,
        ),
    )
