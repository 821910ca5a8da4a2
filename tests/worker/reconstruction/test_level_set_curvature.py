"""Curvature of shapes with a formula, from their implicit equations."""

import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st
from scipy.spatial.transform import Rotation

from worker.reconstruction.level_set_curvature import level_set_curvature

RNG = np.random.default_rng(3)


def directions(count: int) -> np.ndarray:
    points = RNG.standard_normal((count, 3))
    return points / np.linalg.norm(points, axis=1, keepdims=True)


def quadric(points: np.ndarray, matrix: np.ndarray) -> tuple[np.ndarray, np.ndarray]:
    """Derivatives of 1 - x'Mx, which grows inward."""
    hessians = np.broadcast_to(-2.0 * matrix, (len(points), 3, 3)).copy()
    return -2.0 * points @ matrix, hessians


@pytest.mark.parametrize("radius", [0.5, 20.0])
def test_a_sphere(radius: float) -> None:
    points = radius * directions(50)
    gaussian, mean = level_set_curvature(*quadric(points, np.eye(3) / radius**2))
    np.testing.assert_allclose(gaussian, radius**-2.0, rtol=1e-12)
    np.testing.assert_allclose(mean, 1.0 / radius, rtol=1e-12)


def test_a_cylinder() -> None:
    points = np.column_stack([8.0 * np.cos([0.1, 2.0]), 8.0 * np.sin([0.1, 2.0]), [3.0, -9.0]])
    gaussian, mean = level_set_curvature(*quadric(points, np.diag([1.0, 1.0, 0.0]) / 64.0))
    np.testing.assert_allclose(gaussian, 0.0, atol=1e-15)
    np.testing.assert_allclose(mean, 1.0 / 16.0, rtol=1e-12)


def test_an_ellipsoid() -> None:
    """Gaussian curvature h^4 / (abc)^2, h the distance of the tangent plane from the centre."""
    axes = np.array([30.0, 20.0, 45.0])
    points = directions(200) * axes
    gaussian, mean = level_set_curvature(*quadric(points, np.diag(axes**-2.0)))
    support = 1.0 / np.linalg.norm(points / axes**2, axis=1)
    np.testing.assert_allclose(gaussian, support**4 / np.prod(axes) ** 2, rtol=1e-10)
    squares = (points**2).sum(axis=1)
    expected = support**3 * ((axes**2).sum() - squares) / (2.0 * np.prod(axes) ** 2)
    np.testing.assert_allclose(mean, expected, rtol=1e-10)


def test_a_torus() -> None:
    """cos(t) / (r (R + r cos t)), and (R + 2 r cos t) / (2 r (R + r cos t))."""
    ring, tube = 20.0, 6.0
    t, p = RNG.uniform(0.0, 2.0 * np.pi, (2, 100))
    rho = ring + tube * np.cos(t)
    points = np.column_stack([rho * np.cos(p), rho * np.sin(p), tube * np.sin(t)])
    # f = tube^2 - (rho - ring)^2 - z^2
    out = np.column_stack([np.cos(p), np.sin(p), np.zeros(100)])
    up = np.array([0.0, 0.0, 1.0])
    gradients = -2.0 * ((rho - ring)[:, None] * out + points[:, 2:] * up)
    around = np.cross(up, out)
    hessians = -2.0 * (
        out[:, :, None] * out[:, None, :]
        + ((rho - ring) / rho)[:, None, None] * around[:, :, None] * around[:, None, :]
        + np.outer(up, up)
    )
    gaussian, mean = level_set_curvature(gradients, hessians)
    np.testing.assert_allclose(gaussian, np.cos(t) / (tube * rho), atol=1e-12)
    np.testing.assert_allclose(mean, (ring + 2.0 * tube * np.cos(t)) / (2.0 * tube * rho))


@given(st.floats(0.1, 10.0), st.floats(-3.0, 3.0), st.integers(0, 2**16))
def test_neither_turning_nor_steepness_matters_and_size_scales(
    scale: float, angle: float, seed: int
) -> None:
    rng = np.random.default_rng(seed)
    matrix = rng.standard_normal((3, 3))
    hessian = (matrix + matrix.T)[None]
    gradient = rng.standard_normal((1, 3)) + np.array([[3.0, 0.0, 0.0]])
    turn = Rotation.from_rotvec(angle * np.array([0.6, 0.0, 0.8])).as_matrix()
    plain = np.array(level_set_curvature(gradient, hessian))
    turned = level_set_curvature(gradient @ turn.T, turn @ hessian @ turn.T)
    steep = level_set_curvature(5.0 * gradient, 5.0 * hessian)
    larger = level_set_curvature(gradient / scale, hessian / scale**2)
    np.testing.assert_allclose(turned, plain, rtol=1e-7, atol=1e-9)
    np.testing.assert_allclose(steep, plain, rtol=1e-9)
    np.testing.assert_allclose(larger[0], plain[0] / scale**2, rtol=1e-7)
    np.testing.assert_allclose(larger[1], plain[1] / scale, rtol=1e-7)
