"""Planes: fitting, and the way to their axes and back."""

import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st

from intake.planes import Plane, cross, fit_plane, slice_plane
from schemas.problem import InputError, ProblemType
from schemas.study import Contour, Slice

components = st.floats(-1e3, 1e3).map(lambda v: round(v, 3))
vectors = st.tuples(components, components, components).filter(any).map(np.array)


@given(vectors, vectors)
def test_axes_are_orthonormal_and_right_handed(origin: np.ndarray, normal: np.ndarray) -> None:
    plane = Plane.through(origin, normal)
    axes = np.stack([plane.u, plane.v, plane.normal])
    np.testing.assert_allclose(axes @ axes.T, np.eye(3), atol=1e-12)
    assert np.linalg.det(axes) == pytest.approx(1.0)
    assert plane.normal @ normal > 0


@given(vectors, vectors)
def test_to_space_and_back_is_the_identity(origin: np.ndarray, normal: np.ndarray) -> None:
    plane = Plane.through(origin, normal)
    flat = np.random.default_rng(0).uniform(-100, 100, (20, 2))
    space = plane.to_space(flat)
    np.testing.assert_allclose(plane.to_plane(space), flat, atol=1e-9)
    np.testing.assert_allclose(plane.signed_distance(space), 0.0, atol=1e-9)


def test_signed_distance_is_the_shift_along_the_normal() -> None:
    plane = Plane.through(np.zeros(3), np.array([0.0, 3.0, 4.0]))
    shifted = plane.to_space(np.array([[5.0, -2.0]])) + 7.0 * plane.normal
    np.testing.assert_allclose(plane.signed_distance(shifted), 7.0)
    np.testing.assert_allclose(plane.to_plane(shifted), [[5.0, -2.0]], atol=1e-12)


@pytest.mark.parametrize("length", [5e-324, 1e-200, 1.0, 1e7])
def test_a_normal_of_any_length_will_do(length: float) -> None:
    plane = Plane.through(np.zeros(3), np.array([0.0, length, 0.0]))
    np.testing.assert_array_equal(plane.normal, [0.0, 1.0, 0.0])


def test_parallel_planes_share_their_axes() -> None:
    one = Plane.through(np.zeros(3), np.array([0.2, 0.3, 0.9]))
    other = Plane.through(np.full(3, 40.0), np.array([2.0, 3.0, 9.0]))
    np.testing.assert_allclose(one.u, other.u, atol=1e-15)


@given(vectors, vectors)
def test_a_fit_recovers_the_plane(origin: np.ndarray, normal: np.ndarray) -> None:
    true = Plane.through(origin, normal)
    points = true.to_space(np.random.default_rng(1).uniform(-50, 50, (40, 2)))
    fitted = fit_plane(points)
    assert abs(fitted.normal @ true.normal) == pytest.approx(1.0)
    assert fitted.normal[np.argmax(np.abs(fitted.normal))] > 0
    np.testing.assert_allclose(fitted.signed_distance(points), 0.0, atol=1e-8)


def test_a_fit_averages_noise() -> None:
    rng = np.random.default_rng(2)
    points = np.c_[rng.uniform(-50, 50, (400, 2)), rng.normal(0, 0.5, 400)]
    assert fit_plane(points).normal[2] > 0.9999


@pytest.mark.parametrize("points", [np.ones((5, 3)), np.outer(np.arange(9.0), [1, 2, 3])])
def test_points_on_a_line_fix_no_plane(points: np.ndarray) -> None:
    with pytest.raises(InputError) as caught:
        fit_plane(points)
    assert caught.value.type is ProblemType.DEGENERATE_CONTOUR


def test_a_slice_has_its_plane_in_millimetres() -> None:
    triangle = Contour(structure="lv_endo", points=[(0, 0, 2), (1, 0, 2), (0, 1, 2)])
    given_ = Slice(id="a", origin=(0, 0, 2), normal=(0, 0, -5), contours=[triangle])
    plane = slice_plane(given_, 10.0)
    np.testing.assert_array_equal(plane.origin, [0, 0, 20])
    np.testing.assert_array_equal(plane.normal, [0, 0, -1])
    fitted = slice_plane(Slice(id="a", contours=[triangle]), 10.0)
    np.testing.assert_allclose(fitted.origin, [10 / 3, 10 / 3, 20])
    np.testing.assert_allclose(fitted.normal, [0, 0, 1], atol=1e-12)


def test_the_cross_product_is_numpy_s() -> None:
    for a, b in np.random.default_rng(0).normal(size=(100, 2, 3)):
        assert np.array_equal(cross(a, b), np.cross(a, b))
