"""Morphological contour interpolation, as ITK has it and segmentation tools offer it.

Albu, Beugeling and Laurendeau, "A morphology-based approach for interslice interpolation of
anatomical slices from volumetric images", IEEE TBME 55(8), 2008; in ITK by Zukic et al.,
"nD morphological contour interpolation", Insight Journal, 2016.
"""

import warnings
from dataclasses import dataclass

import itk
import numpy as np
from jaxtyping import Bool, Int, UInt8
from scipy.ndimage import distance_transform_edt, gaussian_filter, map_coordinates

from intake.even_odd import inside
from schemas.vocabulary import Structure
from worker.interpolation.level_surface import level_surface
from worker.interpolation.short_axis import ShortAxisStack, short_axis_stack
from worker.reconstruction.slice_stack import SliceStack
from worker.surface_mesh import SurfaceMesh

Labels = UInt8[np.ndarray, "z y x"]
Mask = Bool[np.ndarray, "z y x"]
Layers = Int[np.ndarray, " n"]


def _filled(drawn: Labels) -> Mask:
    """A label map (z, y, x) with the layers between its slices filled in."""
    image = itk.image_from_array(drawn)
    # ITK counts x first, so slices are stacked along axis 2. Repeated dilation, as published:
    # with the distance transform in its place 2 % of the volume is lost.
    full = itk.morphological_contour_interpolator(image, axis=2, use_distance_transform=False)
    return np.asarray(itk.array_from_image(full) > 0)


with warnings.catch_warnings():
    # ITK loads its libraries when first used: here. Where warnings are errors, this one, raised
    # while SWIG makes its types, would end the interpreter.
    warnings.filterwarnings("ignore", "builtin type [Ss]wig", DeprecationWarning)
    # On several threads many processes ended with a corrupted heap (version 2.1.2); on one, none.
    itk.MultiThreaderBase.SetGlobalMaximumNumberOfThreads(1)
    _filled(np.zeros((3, 3, 3), dtype=np.uint8))

_MARGIN = 6
"""Empty voxels around the outlines."""


def morphological(
    stack: SliceStack,
    structure: Structure,
    *,
    voxel_mm: float = 0.5,
    smoothing_mm: float = 1.0,
    cell_mm: float = 1.0,
) -> SurfaceMesh:
    """The surface of `structure`, closed, outward, patient mm.

    Short-axis outlines are filled on pixels of `voxel_mm`; a whole number of layers, each no higher
    than a pixel is wide, makes the median gap, and each slice is on the layer nearest to its
    height. ITK interpolates the layers between, by repeated dilation. The mask becomes a surface
    as its users make one: Gaussian smoothing (`smoothing_mm` is the standard deviation), marching
    cubes at one half, the part that the outlines are on. It ends half a slice gap beyond the first
    and last slice, or halfway to a nearer one where the structure is absent; on the way there the
    end slice shrinks as fast as it is left behind.
    Raises InputError for fewer than two short-axis slices, or for slices that are not a stack.
    """
    slices = short_axis_stack(stack, structure)
    grid = _Grid.around(slices, voxel_mm)
    drawn = np.zeros(grid.shape, dtype=np.uint8)
    layers = grid.layers(slices.heights_mm)
    for layer, rings in zip(layers, slices.rings, strict=True):
        drawn[layer] = inside(grid.pixels_mm(), rings).reshape(grid.shape[1:])
    filled = _filled(drawn)
    _close_ends(filled, layers, grid, slices)
    soft = gaussian_filter(filled.astype(np.float64), smoothing_mm / grid.spacing_mm)

    def field(points_mm: np.ndarray) -> np.ndarray:
        at = (points_mm - grid.origin_mm)[:, ::-1] / grid.spacing_mm
        return (map_coordinates(soft, at.T, order=1, mode="nearest") - 0.5)[:, None]

    mesh = level_surface(field, grid.origin_mm, grid.last_mm, cell_mm, slices.outline_points)
    in_space = slices.to_space(mesh.vertices_mm[:, :2], mesh.vertices_mm[:, 2])
    return SurfaceMesh(in_space, mesh.faces)


@dataclass(frozen=True, eq=False)
class _Grid:
    """Voxels (z, y, x) in the stack's own axes. origin_mm: (x, y, z) of the first one's centre.

    spacing_mm: (3,) in the order z, y, x.
    """

    origin_mm: np.ndarray
    spacing_mm: np.ndarray
    shape: tuple[int, int, int]

    @staticmethod
    def around(slices: ShortAxisStack, voxel_mm: float) -> "_Grid":
        """Its first slice is exactly on a layer; slices share one only where they are nearer to
        each other than a quarter of a pixel.
        """
        closest = max(float(np.diff(slices.heights_mm).min()), voxel_mm / 4.0)
        layer_mm = slices.gap_mm / np.ceil(slices.gap_mm / min(voxel_mm, closest) - 1e-6)
        spacing = np.array([layer_mm, voxel_mm, voxel_mm])
        flat = slices.outline_points[:, :2]
        below = _MARGIN + np.ceil((slices.heights_mm[0] - slices.bottom_mm) / layer_mm)
        low = np.array(
            [
                *(flat.min(axis=0) - _MARGIN * voxel_mm),
                slices.heights_mm[0] - below * layer_mm,
            ]
        )
        high = np.array([*flat.max(axis=0), slices.top_mm]) + _MARGIN * voxel_mm
        z, y, x = (int(n) + 1 for n in np.ceil((high - low)[::-1] / spacing))
        return _Grid(low, spacing, (z, y, x))

    @property
    def last_mm(self) -> np.ndarray:
        return self.origin_mm + ((np.array(self.shape) - 1) * self.spacing_mm)[::-1]

    def layers(self, heights_mm: np.ndarray) -> Layers:
        """The layer nearest to each height."""
        return np.floor((heights_mm - self.origin_mm[2]) / self.spacing_mm[0] + 0.5).astype(
            np.int64
        )

    def pixels_mm(self) -> np.ndarray:
        """Centres of a layer's pixels, (y x, 2), mm."""
        x, y = (
            self.origin_mm[axis] + self.spacing_mm[1] * np.arange(self.shape[2 - axis])
            for axis in (0, 1)
        )
        return np.stack(np.meshgrid(x, y), axis=-1).reshape(-1, 2)


def _close_ends(filled: Mask, layers: Layers, grid: _Grid, slices: ShortAxisStack) -> None:
    """Fills the layers beyond the ends, up to where the structure is taken to end."""
    for end, step, reach_mm in (
        (layers[0], -1, slices.heights_mm[0] - slices.bottom_mm),
        (layers[-1], 1, slices.top_mm - slices.heights_mm[-1]),
    ):
        depth_mm = distance_transform_edt(filled[end], sampling=grid.spacing_mm[1:])
        count = round(reach_mm / grid.spacing_mm[0] - 0.5)
        for beyond in range(1, count + 1):
            filled[end + step * beyond] = depth_mm > beyond * grid.spacing_mm[0]
