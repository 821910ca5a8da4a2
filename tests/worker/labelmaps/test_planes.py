"""Slices of a voxel grid: which axis counts them, and where a pixel lies."""

import io

import numpy as np
import pytest

from intake.label_maps import check_label_maps
from intake.limits import Limits
from schemas.labels import LabelRequest
from schemas.vocabulary import View
from tests.labelmaps.nifti_bytes import nifti
from worker.labelmaps.planes import PlaneStack, plane_stack


def oblique(sizes: tuple[float, float, float], handedness: float = 1.0) -> np.ndarray:
    rotation, _ = np.linalg.qr(np.random.default_rng(3).normal(size=(3, 3)))
    affine = np.eye(4)
    affine[:3, :3] = rotation @ np.diag(sizes) @ np.diag([handedness, 1.0, 1.0])
    affine[:3, 3] = 12.0, -30.0, 7.0
    return affine


def stack(shape: tuple[int, int, int], affine: np.ndarray) -> PlaneStack:
    data = io.BytesIO(nifti(np.zeros(shape, np.uint8), affine))
    request = LabelRequest(subject_id="s", label_scheme="acdc")
    return plane_stack(check_label_maps({View.SAX: data}, request, Limits())[View.SAX])


@pytest.mark.parametrize(
    ("shape", "sizes", "axis"),
    [
        ((8, 7, 6), (1.5, 1.5, 8.0), 2),
        ((8, 7, 6), (1.5, 1.5, 1.5), 2),
        ((8, 7, 6), (1.5, 1.6, 1.5), 2),
        ((6, 8, 7), (8.0, 1.5, 1.5), 0),
        ((8, 6, 7), (1.5, 8.0, 1.5), 1),
        ((8, 1, 7), (1.5, 1.5, 1.5), 1),
        ((1, 8, 7), (1.0, 1.5, 1.5), 0),
        ((8, 7, 1), (1.5, 1.5, 1.0), 2),
    ],
)
def test_slice_axis(shape: tuple, sizes: tuple, axis: int) -> None:
    found = stack(shape, oblique(sizes))
    assert (found.slice_axis, found.count) == (axis, shape[axis])


@pytest.mark.parametrize("axis", [0, 1, 2])
@pytest.mark.parametrize("handedness", [1.0, -1.0])
def test_pixels_lie_where_the_affine_puts_their_voxels(axis: int, handedness: float) -> None:
    sizes = tuple(np.roll([1.5, 2.0, 8.0], axis + 1).tolist())
    affine = oblique(sizes, handedness)
    shape = tuple(np.roll([9, 8, 5], axis + 1).tolist())
    planes = stack(shape, affine)
    assert planes.slice_axis == axis
    pixels = np.random.default_rng(0).uniform(0, 7, (20, 2))
    points_mm = planes.to_space(pixels, 3)
    voxels = (np.column_stack([points_mm, np.ones(20)]) @ np.linalg.inv(affine).T)[:, :3]
    np.testing.assert_allclose(np.delete(voxels, axis, axis=1), pixels, atol=1e-5)
    np.testing.assert_allclose(voxels[:, axis], 3.0, atol=1e-6)
    np.testing.assert_allclose((points_mm - planes.centre_mm(3)) @ planes.normal, 0.0, atol=1e-5)
    assert (planes.centre_mm(3) - planes.centre_mm(2)) @ planes.normal == pytest.approx(8.0)
    np.testing.assert_allclose(np.sort(planes.pixel_mm), [1.5, 2.0], rtol=1e-6)
