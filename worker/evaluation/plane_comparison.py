"""Two closed surfaces cut by one plane: how far apart their contours are there, and how much of
what they enclose is shared.
"""

from collections.abc import Sequence
from dataclasses import dataclass

import numpy as np

from intake.planes import Plane
from worker.arrays import SomePoints, SomeScalars, Vector
from worker.evaluation.plane_overlap import dice, enclosed
from worker.evaluation.section import section
from worker.evaluation.segment_distance import distance_to_segments_mm, ring_segments
from worker.surface_mesh import SurfaceMesh

_SPACING_MM = 0.25
"""Of the points along a contour: a tenth of a pixel of cardiac images, more or less."""

Loops = Sequence[SomePoints]
"""Contours (k, 3) in one plane, mm, the last point joining the first."""


@dataclass(frozen=True, eq=False)
class PlaneComparison:
    """Both contours on one plane.

    to_reference_mm: (n,) distances within the plane from points spread evenly along the surface's
        contour to the nearest point of the reference's, between its vertices too.
        from_reference_mm: (m,) the other way.
    dice: overlap of what both enclose, 1 at best.
    """

    to_reference_mm: SomeScalars
    from_reference_mm: SomeScalars
    dice: float


@dataclass(frozen=True, eq=False)
class PlanesComparison:
    """Several planes together.

    planes: how many cut both surfaces. distances_mm: (n,) of all, both ways, so that a contour
    weighs as much as it is long. dice_mean, dice_min: over planes, each weighing the same.
    """

    planes: int
    distances_mm: SomeScalars
    dice_mean: float
    dice_min: float


def compare_on_plane(
    mesh: SurfaceMesh, reference: SurfaceMesh, origin_mm: Vector, normal: Vector
) -> PlaneComparison | None:
    """Both surfaces, closed and in one frame, on the plane through `origin_mm` (3,) across `normal`
    (3,), of any length but zero; None where it does not cut both.
    """
    own, true = (section(one, origin_mm, normal) for one in (mesh, reference))
    if not own or not true:
        return None
    plane = Plane.through(origin_mm, normal)
    areas = [enclosed([plane.to_plane(loop) for loop in loops]) for loops in (own, true)]
    overlap = dice(*areas)
    if overlap is None:
        return None
    return PlaneComparison(_distances_mm(own, true), _distances_mm(true, own), overlap)


def pooled(comparisons: Sequence[PlaneComparison]) -> PlanesComparison:
    """Planes, at least one, together."""
    overlaps = [one.dice for one in comparisons]
    return PlanesComparison(
        planes=len(comparisons),
        distances_mm=np.concatenate(
            [part for one in comparisons for part in (one.to_reference_mm, one.from_reference_mm)]
        ),
        dice_mean=float(np.mean(overlaps)),
        dice_min=min(overlaps),
    )


def _distances_mm(own: Loops, other: Loops) -> SomeScalars:
    points = np.concatenate([_spread_along(loop) for loop in own])
    first = np.cumsum([0, *(len(loop) for loop in other[:-1])])
    segments = np.concatenate(
        [start + ring_segments(len(loop)) for start, loop in zip(first, other, strict=True)]
    )
    return distance_to_segments_mm(points, np.concatenate(other), segments)


def _spread_along(loop_mm: SomePoints) -> SomePoints:
    """Points evenly along a loop, whatever the distances between its own."""
    round_trip = np.concatenate([loop_mm, loop_mm[:1]])
    along = np.cumsum([0.0, *np.linalg.norm(np.diff(round_trip, axis=0), axis=1)])
    count = int(np.ceil(along[-1] / _SPACING_MM))
    places = (np.arange(count) + 0.5) * along[-1] / count
    return np.column_stack([np.interp(places, along, column) for column in round_trip.T])
