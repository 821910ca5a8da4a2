"""The inflated convex hull of all contours: nothing of the heart lies on it or beyond it."""

import math
from dataclasses import dataclass

import numpy as np
from jaxtyping import Float
from scipy.spatial import ConvexHull, QhullError

from schemas.problem import InputError, ProblemType
from worker.arrays import Flags, Points, Vector

_BOX_MARGIN = 0.06
"""Room around the hull in unit lengths, so that the isosurface never meets the box."""


@dataclass(frozen=True, eq=False)
class Hull:
    """Triangles of the inflated hull, how far it reaches in many directions, and its box."""

    triangles_unit: Float[np.ndarray, "m 3 3"]
    reach: Float[np.ndarray, " directions"]
    lower: Vector
    upper: Vector

    def on_surface(self, count: int, rng: np.random.Generator) -> Points:
        """`count` points spread evenly over the hull's area, (n, 3) unit."""
        a, b, c = np.moveaxis(self.triangles_unit, 1, 0)
        areas = np.linalg.norm(np.cross(b - a, c - a), axis=1)
        chosen = rng.choice(len(a), size=count, p=areas / areas.sum())
        u, v = rng.random((2, count, 1))
        flip = u + v > 1.0
        u, v = np.where(flip, 1.0 - u, u), np.where(flip, 1.0 - v, v)
        start = a[chosen]
        return start + u * (b[chosen] - start) + v * (c[chosen] - start)

    def beyond(self, count: int, rng: np.random.Generator) -> Points:
        """`count` points spread evenly over the box where it is clear of the hull, (n, 3) unit."""
        found: list[Points] = []
        missing = count
        while missing > 0:
            candidates = rng.uniform(self.lower, self.upper, size=(2 * count, 3))
            outside = candidates[self._is_outside(candidates)][:missing]
            found.append(outside)
            missing -= len(outside)
        return np.concatenate(found) if found else np.empty((0, 3))

    def _is_outside(self, points_unit: Points) -> Flags:
        return (points_unit @ _DIRECTIONS.T > self.reach).any(axis=1)


def _spread_directions(count: int) -> Float[np.ndarray, "count 3"]:
    """Unit vectors spread evenly over the sphere, on a Fibonacci spiral."""
    z = 1.0 - (2.0 * np.arange(count) + 1.0) / count
    turn = np.arange(count) * math.pi * (3.0 - math.sqrt(5.0))
    across = np.sqrt(1.0 - z**2)
    return np.column_stack([across * np.cos(turn), across * np.sin(turn), z])


_DIRECTIONS = _spread_directions(400)
"""A hull of dense contours has thousands of faces. These bound it within a hundredth of its size,
and what is beyond them is beyond it."""


def inflated_hull(points_unit: Points, inflation: float) -> Hull:
    """The convex hull of (n, 3) points, scaled by `inflation` about its centroid.

    Raises InputError when the points lie in one plane.
    """
    centroid = points_unit.mean(axis=0)
    inflated = centroid + inflation * (points_unit - centroid)
    try:
        hull = ConvexHull(inflated)
    except QhullError as error:
        raise InputError(
            ProblemType.TOO_FEW_SLICES,
            "All contours lie in one plane, which says nothing about the third dimension; "
            "add slices at other positions or a long-axis view.",
        ) from error
    return Hull(
        triangles_unit=inflated[hull.simplices],
        reach=(inflated[hull.vertices] @ _DIRECTIONS.T).max(axis=0),
        lower=inflated.min(axis=0) - _BOX_MARGIN,
        upper=inflated.max(axis=0) + _BOX_MARGIN,
    )
