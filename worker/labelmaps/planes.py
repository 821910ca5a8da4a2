"""The parallel planes of a label map: which voxel axis counts slices, and where each plane lies."""

from dataclasses import dataclass

import numpy as np
from jaxtyping import Float

from intake.label_maps import CheckedMap
from worker.arrays import PlanePoints, Points, Vector

_THICKER = 1.2
"""How many times larger than the third axis's a spacing must be for its axis to count slices."""


@dataclass(frozen=True, eq=False)
class PlaneStack:
    """A label map's slices.

    affine_mm: voxel index (of a voxel's centre) to RAS, mm. shape: voxels an axis.
    slice_axis: the voxel axis that counts slices; the other two, in order, are in plane.
    """

    affine_mm: Float[np.ndarray, "4 4"]
    shape: tuple[int, int, int]
    slice_axis: int

    @property
    def count(self) -> int:
        return self.shape[self.slice_axis]

    @property
    def pixel_mm(self) -> Float[np.ndarray, "2"]:
        """Size of a pixel along the two in-plane axes."""
        lengths: np.ndarray = np.linalg.norm(self._in_plane, axis=0)
        return lengths

    @property
    def normal(self) -> Vector:
        """Unit, towards higher slice numbers."""
        across = np.cross(self._in_plane[:, 0], self._in_plane[:, 1])
        across /= np.linalg.norm(across)
        return across * np.sign(across @ self.affine_mm[:3, self.slice_axis])

    @property
    def _in_plane(self) -> Float[np.ndarray, "3 2"]:
        axes = [axis for axis in range(3) if axis != self.slice_axis]
        return self.affine_mm[:3, axes]

    def centre_mm(self, index: int) -> Vector:
        """The middle of a slice's image."""
        voxel = (np.array(self.shape) - 1) / 2
        voxel[self.slice_axis] = index
        return self.affine_mm[:3, :3] @ voxel + self.affine_mm[:3, 3]

    def to_space(self, pixels: PlanePoints, index: int) -> Points:
        """RAS mm of in-plane pixel coordinates (centres are integers) on slice `index`."""
        voxels = np.insert(pixels, self.slice_axis, index, axis=1)
        return voxels @ self.affine_mm[:3, :3].T + self.affine_mm[:3, 3]


def plane_stack(checked: CheckedMap) -> PlaneStack:
    """The slices of a map: along its one singleton axis, else a much thicker one, else the third.

    Slice thickness tells, since NIfTI leaves the order of the axes free.
    """
    shape, spacing = checked.header.shape, checked.geometry.spacing_mm
    single = [axis for axis in range(3) if shape[axis] == 1]
    thickest = int(np.argmax(spacing))
    if len(single) == 1:
        axis = single[0]
    else:
        axis = thickest if spacing[thickest] > _THICKER * spacing[2] else 2
    return PlaneStack(np.array(checked.geometry.affine_mm), shape, axis)
