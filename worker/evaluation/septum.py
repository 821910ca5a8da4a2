"""Which points of a ventricle's surface face the other ventricle."""

from collections.abc import Mapping, Sequence
from dataclasses import dataclass

import numpy as np
from jaxtyping import Bool

from schemas.vocabulary import Structure
from worker.arrays import SomePoints, Vector
from worker.evaluation.area_centroid import area_centroid_mm
from worker.surface_mesh import SurfaceMesh

_WITHIN = 0.5
"""Cosine of 60 degrees: the septum is two of the six segments about the left ventricle."""

_BESIDE = 0.1
"""In mean distances of the left ventricle from its own axis: nearer to the axis than this, the
right ventricle gives no direction."""

_LEFT = (Structure.LV_ENDO, Structure.LV_EPI)
_RIGHT = (Structure.RV_ENDO, Structure.RV_EPI)

SomeFlags = Bool[np.ndarray, "_"]


@dataclass(frozen=True, eq=False)
class LongAxis:
    """The left ventricle's: a line through `centre_mm` (3,) along the unit vector `along` (3,)."""

    centre_mm: Vector
    along: Vector

    def outward_mm(self, points_mm: SomePoints) -> SomePoints:
        """From the nearest point of the axis to each of (n, 3) points, (n, 3)."""
        from_centre = points_mm - self.centre_mm
        return from_centre - np.outer(from_centre @ self.along, self.along)


@dataclass(frozen=True, eq=False)
class LeftSeptum:
    """The part of a left ventricle's surface within 60 degrees about the long axis from the
    direction `toward_rv` (3,), unit and across it: the septal segments 2, 3, 8 and 9 of the
    American Heart Association, and the same sector at the apex. A point on the axis is no part.
    """

    axis: LongAxis
    toward_rv: Vector

    def __call__(self, points_mm: SomePoints, normals: SomePoints) -> SomeFlags:
        """Of each of (n, 3) points; their normals do not matter."""
        outward = self.axis.outward_mm(points_mm)
        septal: SomeFlags = outward @ self.toward_rv > _WITHIN * np.linalg.norm(outward, axis=1)
        return septal


@dataclass(frozen=True, eq=False)
class RightSeptum:
    """The part of a right ventricle's surface whose outward normal points within 60 degrees of the
    shortest way to the left ventricle's long axis.
    """

    axis: LongAxis

    def __call__(self, points_mm: SomePoints, normals: SomePoints) -> SomeFlags:
        """Of each of (n, 3) points with outward unit normals (n, 3)."""
        inward = -self.axis.outward_mm(points_mm)
        toward_axis = np.einsum("nd,nd->n", inward, normals)
        septal: SomeFlags = toward_axis > _WITHIN * np.linalg.norm(inward, axis=1)
        return septal


@dataclass(frozen=True)
class NoSeptum:
    """A surface that cannot be split, and why."""

    reason: str


def septum(
    structure: Structure, surfaces: Mapping[Structure, SurfaceMesh], toward_base: Vector | None
) -> LeftSeptum | RightSeptum | NoSeptum:
    """What tells the septum of one of a frame's surfaces from its free wall.

    surfaces: of the frame, mm, that one among them; they may be open. toward_base: (3,) the unit
    vector along the long axis, None where it is not known. The axis goes through the centroid of
    lv_endo, or of lv_epi where there is no lv_endo; it is the same for both ventricles' surfaces.
    """
    if structure is Structure.EPI:
        return NoSeptum("epi goes around both ventricles and has no septum.")
    if toward_base is None:
        return NoSeptum("Without short-axis slices the long axis is not known.")
    left, right = _first(_LEFT, surfaces), _first(_RIGHT, surfaces)
    if left is None:
        return NoSeptum("Without lv_endo nothing shows where the septum is; ask for it as well.")
    axis = LongAxis(area_centroid_mm(left), toward_base)
    if structure in _RIGHT:
        return RightSeptum(axis)
    if right is None:
        return NoSeptum("Without rv_endo nothing shows where the septum is; ask for it as well.")
    aside_mm = axis.outward_mm(area_centroid_mm(right)[None])[0]
    distance_mm = float(np.linalg.norm(aside_mm))
    radius_mm = float(np.linalg.norm(axis.outward_mm(left.vertices_mm), axis=1).mean())
    if distance_mm <= _BESIDE * radius_mm:
        return NoSeptum("The right ventricle is not beside the left, so nothing shows the septum.")
    return LeftSeptum(axis, aside_mm / distance_mm)


def _first(
    structures: Sequence[Structure], surfaces: Mapping[Structure, SurfaceMesh]
) -> SurfaceMesh | None:
    return next((surfaces[one] for one in structures if one in surfaces), None)
