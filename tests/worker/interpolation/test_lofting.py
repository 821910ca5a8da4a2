from dataclasses import replace

import numpy as np
from shapely.geometry import Polygon

from tests.worker.interpolation.stacks import STRUCTURE, cylinder, heights_mm
from worker.evaluation.size import area_cm2
from worker.interpolation.lofting import lofted
from worker.interpolation.short_axis import short_axis_stack
from worker.reconstruction.slice_stack import Outline, SliceStack


def begun_anywhere(stack: SliceStack) -> SliceStack:
    """Each outline begins at another point, and every second one runs the other way round."""
    slices = []
    for k, slice_ in enumerate(stack.slices):
        (outline,) = slice_.outlines[STRUCTURE]
        points = np.roll(outline.points_mm, 37 * k, axis=0)[:: -1 if k % 2 else 1]
        outlines = {STRUCTURE: (Outline(np.ascontiguousarray(points), True),)}
        slices.append(replace(slice_, outlines=outlines))
    return replace(stack, slices=tuple(slices))


def test_where_outlines_begin_twists_nothing() -> None:
    """A twisted skin would be waisted like an hourglass."""
    plain, turned = (lofted(s, STRUCTURE) for s in (cylinder(), begun_anywhere(cylinder())))
    assert abs(area_cm2(turned) / area_cm2(plain) - 1.0) <= 0.005


def test_every_ring_is_simple() -> None:
    mesh = lofted(cylinder(), STRUCTURE)
    levels = heights_mm(mesh.vertices_mm[:-2]).round(6)
    slices = short_axis_stack(cylinder(), STRUCTURE)
    for level in np.unique(levels):
        ring = slices.base.to_plane(mesh.vertices_mm[:-2][levels == level])
        assert Polygon(ring).is_simple
        assert Polygon(ring).is_valid
