"""From patient millimetres to a frame of the heart's own, and back: the only place that knows both.

The unit frame is centred on the contours, its z axis is the short-axis normal and its half-extent
is one, so that a study moved or turned as a whole is the same study in unit coordinates.
"""

from collections.abc import Mapping
from dataclasses import dataclass

import numpy as np

from schemas.vocabulary import Structure, View
from worker.arrays import Points, Rotation, Vector
from worker.reconstruction.slice_stack import SliceStack, StackSlice
from worker.reconstruction.unit_stack import UnitOutline, UnitSlice, UnitStack


@dataclass(frozen=True, eq=False)
class UnitFrame:
    """x_unit = rotation (x_mm - centre_mm) / half_extent_mm.

    rotation: (3, 3) orthonormal, its rows are the unit frame's axes in patient axes.
    """

    centre_mm: Vector
    half_extent_mm: float
    rotation: Rotation

    def to_unit(self, points_mm: Points) -> Points:
        """(n, 3) mm, patient axes, to unit coordinates."""
        return (points_mm - self.centre_mm) @ self.rotation.T / self.half_extent_mm

    def to_mm(self, points_unit: Points) -> Points:
        """(n, 3) unit coordinates to mm, patient axes: the inverse of `to_unit`."""
        return points_unit @ self.rotation * self.half_extent_mm + self.centre_mm

    def direction_to_unit(self, direction: Vector) -> Vector:
        """A direction in patient axes, turned into the unit frame, length kept."""
        return self.rotation @ direction

    def displacement_to_mm(self, displacement_unit: Points) -> Points:
        """(n, 3) differences of unit points to mm, patient axes."""
        return displacement_unit @ self.rotation * self.half_extent_mm


def normalise(stack: SliceStack) -> tuple[UnitStack, UnitFrame]:
    """The stack in unit coordinates, and the frame that brings results back."""
    frame = unit_frame_of(stack)
    return normalised(stack, frame), frame


def normalised(stack: SliceStack, frame: UnitFrame) -> UnitStack:
    """The stack in a unit frame, its own or one that it has in common with other frames' stacks."""
    return UnitStack(tuple(_normalise_slice(s, frame) for s in stack.slices))


def unit_frame_of(stack: SliceStack) -> UnitFrame:
    """The frame in which the stack's contours fill [-1, 1] along their longest side."""
    points_mm = stack.points_mm
    rotation = _intrinsic_axes(stack, points_mm)
    turned = points_mm @ rotation.T
    low, high = turned.min(axis=0), turned.max(axis=0)
    centre_mm = 0.5 * (low + high) @ rotation
    return UnitFrame(centre_mm, float(0.5 * (high - low).max()), rotation)


def _normalise_slice(slice_: StackSlice, frame: UnitFrame) -> UnitSlice:
    normal = frame.direction_to_unit(slice_.normal)
    across, along = _in_plane_axes(normal)
    origin = frame.to_unit(slice_.origin_mm[None])[0]
    origin = normal * float(origin @ normal)
    axes = np.stack([across, along])
    outlines: Mapping[Structure, tuple[UnitOutline, ...]] = {
        structure: tuple(
            UnitOutline((frame.to_unit(o.points_mm) - origin) @ axes.T, o.closed) for o in outlines
        )
        for structure, outlines in slice_.outlines.items()
    }
    return UnitSlice(slice_.id, slice_.view, origin, axes, outlines, slice_.absent)


def _in_plane_axes(normal: Vector) -> tuple[Vector, Vector]:
    helper = np.eye(3)[int(np.argmin(np.abs(normal)))]
    across = np.cross(normal, helper)
    across /= np.linalg.norm(across)
    return across, np.cross(normal, across)


def _intrinsic_axes(stack: SliceStack, points_mm: Points) -> Rotation:
    """Rows x, y, z: z along the short-axis normal, x along the widest direction across it.

    Signs come from the third moment of the points, so they turn with the heart.
    """
    centred = points_mm - points_mm.mean(axis=0)
    normals = [s.normal for s in stack.slices if s.view is View.SAX]
    if normals:
        aligned = [n if n @ normals[0] >= 0 else -n for n in normals]
        z = np.mean(aligned, axis=0)
        z /= np.linalg.norm(z)
    else:
        z = np.linalg.eigh(centred.T @ centred)[1][:, 2]
    z = _skewed(z, centred)
    across = centred - (centred @ z)[:, None] * z
    x = np.linalg.eigh(across.T @ across)[1][:, 2]
    x -= (x @ z) * z
    x = _skewed(x / np.linalg.norm(x), centred)
    return np.stack([x, np.cross(z, x), z])


def _skewed(axis: Vector, centred: Points) -> Vector:
    return axis if float(((centred @ axis) ** 3).sum()) >= 0.0 else -axis
