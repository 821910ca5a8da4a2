"""How well a surface's section covers what was outlined on that plane."""

from collections.abc import Sequence

import numpy as np
import shapely
from shapely.geometry import MultiPolygon, Polygon
from shapely.geometry.base import BaseGeometry

from intake.planes import Plane
from worker.arrays import PlanePoints, SomePlanePoints, SomePoints
from worker.evaluation.support import AlignedOutline


def plane_dice(
    loops_mm: Sequence[SomePoints], outlines: Sequence[AlignedOutline], plane: Plane
) -> float | None:
    """Dice coefficient between what outlines enclose on a plane and what a surface does there.

    2 |A and B| / (|A| + |B|): 1 for the same areas, 0 for disjoint ones; None where neither
    encloses anything. loops_mm: the closed surface's section, (n, 3) each. Rings in one another
    are holes. Where an outline is open, what the surface encloses beyond its chord is left out:
    there it was not asked.
    """
    own = enclosed([plane.to_plane(one.points_mm) for one in outlines])
    cut = enclosed([plane.to_plane(loop) for loop in loops_mm])
    for one in outlines:
        if not one.closed:
            cut = _before_chord(cut, plane.to_plane(one.points_mm))
    return dice(own, cut)


def dice(one: BaseGeometry, other: BaseGeometry) -> float | None:
    """Twice what two areas share over the sum of both; None where neither has any."""
    both = one.area + other.area
    return float(2.0 * shapely.intersection(one, other).area / both) if both > 0.0 else None


def enclosed(rings: Sequence[SomePlanePoints]) -> BaseGeometry:
    """What closed rings, (n, 2) each, enclose by the even-odd rule: a ring in a ring is a hole."""
    area: BaseGeometry = MultiPolygon()
    for ring in rings:
        if len(ring) > 2:
            area = shapely.symmetric_difference(area, shapely.make_valid(Polygon(ring)))
    return area


def _before_chord(area: BaseGeometry, ring: PlanePoints) -> BaseGeometry:
    """The part of `area` on that side of the line through an arc's ends where the arc runs."""
    start, end = ring[0], ring[-1]
    chord = end - start
    length = float(np.linalg.norm(chord))
    if length == 0.0:
        return area
    chord = chord / length
    inward = np.array([-chord[1], chord[0]])
    if (ring - start).mean(axis=0) @ inward < 0.0:
        inward = -inward
    low, high = np.array(area.bounds[:2] or [0.0, 0.0]), np.array(area.bounds[2:] or [0.0, 0.0])
    reach = float(np.linalg.norm(high - low)) + float(np.abs(ring).sum(axis=1).max()) + 1.0
    left, right = start - reach * chord, end + reach * chord
    half_plane = Polygon([left, right, right + 2.0 * reach * inward, left + 2.0 * reach * inward])
    return shapely.intersection(area, half_plane)
