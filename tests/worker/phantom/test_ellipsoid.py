import numpy as np
import pytest

from worker.phantom.ellipsoid import Ellipsoid

EGG = Ellipsoid((1.0, 2.0, 3.0), (10.0, 20.0, 40.0))


def on_surface(count: int) -> tuple[np.ndarray, np.ndarray]:
    """Points on EGG and the outward unit normals there."""
    directions = np.random.default_rng(0).normal(size=(count, 3))
    directions /= np.linalg.norm(directions, axis=1, keepdims=True)
    semi_axes = np.array(EGG.semi_axes_mm)
    normals = directions / semi_axes
    return directions * semi_axes + EGG.centre_mm, normals / np.linalg.norm(
        normals, axis=1, keepdims=True
    )


def test_a_sphere_has_its_exact_distance():
    ball = Ellipsoid((0.0, 0.0, 0.0), (5.0, 5.0, 5.0))
    points = np.array([[0.0, 0, 0], [3, 0, 0], [0, 5, 0], [0, 0, 9], [3, 4, 12]])
    np.testing.assert_allclose(ball.signed_mm(points), [-5, -2, 0, 4, 8], atol=1e-12)


def test_it_is_zero_on_the_surface_and_a_distance_near_it():
    points, normals = on_surface(500)
    np.testing.assert_allclose(EGG.signed_mm(points), 0.0, atol=1e-12)
    for offset in (-0.01, 0.01):
        near = EGG.signed_mm(points + offset * normals)
        np.testing.assert_allclose(near, offset, rtol=0.01)


def test_the_volume_agrees_with_counting_points():
    box = np.random.default_rng(1).uniform(-1.0, 1.0, size=(400_000, 3)) * EGG.semi_axes_mm
    points = box + EGG.centre_mm
    inside = (EGG.signed_mm(points) < 0.0) & (points[:, 2] < 15.0)
    counted_ml = inside.mean() * 8.0 * np.prod(EGG.semi_axes_mm) / 1000.0
    assert EGG.volume_below_ml(15.0) == pytest.approx(counted_ml, rel=5e-3)


def test_under_its_top_lies_the_whole_volume():
    assert EGG.volume_below_ml(43.0) == pytest.approx(4 / 3 * np.pi * 8.0)
    assert EGG.volume_below_ml(3.0) == pytest.approx(2 / 3 * np.pi * 8.0)
