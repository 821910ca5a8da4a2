"""The plane of a slice, and the way between space and its own two axes."""

from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

from schemas.problem import InputError, ProblemType
from schemas.study import Slice

Array = NDArray[np.float64]

COLLINEAR = 1e-3
"""Width over length below which points are taken for a line."""


@dataclass(frozen=True, eq=False)
class Plane:
    """A plane in patient space, mm, with orthonormal in-plane axes: `u` x `v` = `normal`.

    The axes depend on the normal alone, so parallel slices share them; they follow the patient
    axes and do not rotate with the study.
    """

    origin: Array
    """(3,) a point of the plane, mm"""
    normal: Array
    """(3,) unit"""
    u: Array
    """(3,) unit, first in-plane axis"""
    v: Array
    """(3,) unit, second in-plane axis"""

    @staticmethod
    def through(origin_mm: Array, normal: Array) -> "Plane":
        """The plane through `origin_mm` (3,) across `normal` (3,), of any length but zero."""
        origin = np.asarray(origin_mm, dtype=np.float64)
        direction = np.asarray(normal, dtype=np.float64)
        # Scaled first: squaring a tiny component would underflow to a zero length.
        direction = direction / np.abs(direction).max()
        n = direction / np.linalg.norm(direction)
        helper = np.zeros(3)
        # The patient axis least along the normal; rounded, so that a tie has one answer.
        helper[int(np.argmin(np.abs(n).round(9)))] = 1.0
        u = helper - (helper @ n) * n
        u /= np.linalg.norm(u)
        return Plane(origin=origin, normal=n, u=u, v=cross(n, u))

    def to_plane(self, points_mm: Array) -> Array:
        """In-plane coordinates (n, 2), mm, of the feet of points (n, 3)."""
        return (points_mm - self.origin) @ np.stack([self.u, self.v], axis=1)

    def to_space(self, plane_points: Array) -> Array:
        """Patient coordinates (n, 3), mm, of in-plane points (n, 2)."""
        return self.origin + plane_points @ np.stack([self.u, self.v])

    def signed_distance(self, points_mm: Array) -> Array:
        """Distance (n,), mm, of points (n, 3) from the plane, positive along the normal."""
        distance: Array = (points_mm - self.origin) @ self.normal
        return distance


def cross(a: Array, b: Array) -> Array:
    """The cross product of two vectors (3,). numpy's own takes ten times as long for one pair."""
    (ax, ay, az), (bx, by, bz) = a.tolist(), b.tolist()
    return np.array([ay * bz - az * by, az * bx - ax * bz, ax * by - ay * bx])


def fit_plane(points_mm: Array) -> Plane:
    """The least-squares plane of points (n, 3), mm, through their centroid.

    Of the two normals, the one whose largest component is positive.

    Raises:
        InputError: `DEGENERATE_CONTOUR` when the points are on one line and fix no plane.
    """
    points = np.asarray(points_mm, dtype=np.float64)
    centroid = points.mean(axis=0)
    _, widths, directions = np.linalg.svd(points - centroid, full_matrices=False)
    if len(widths) < 2 or widths[1] <= COLLINEAR * widths[0]:
        raise InputError(
            ProblemType.DEGENERATE_CONTOUR,
            "the points are on one line, so no plane can be fitted to them. "
            "Remedy: give the slice's `origin` and `normal`, or more of the outline.",
        )
    normal = directions[2]
    return Plane.through(centroid, normal * np.sign(normal[np.argmax(np.abs(normal))]))


def slice_plane(slice_: Slice, millimetres: float) -> Plane:
    """The plane of a slice: as given, else fitted to all its contours.

    `millimetres` is how many of them one of the study's units is.

    Raises:
        InputError: `DEGENERATE_CONTOUR` when no plane is given and the points fix none.
    """
    if slice_.origin is not None and slice_.normal is not None:
        return Plane.through(np.array(slice_.origin) * millimetres, np.array(slice_.normal))
    points = np.concatenate([np.array(c.points, dtype=np.float64) for c in slice_.contours])
    return fit_plane(points * millimetres)
