import numpy as np
import pytest

from worker.evaluation.residuals import contour_residuals_mm

SQUARE = np.array([[-5.0, -5, 0], [5, -5, 0], [5, 5, 0], [-5, 5, 0]])


def test_an_outline_on_the_surface_has_no_residual(cube):
    np.testing.assert_allclose(contour_residuals_mm(SQUARE, cube), 0.0, atol=1e-12)


def test_an_outline_outside_has_its_distance(cube):
    np.testing.assert_allclose(
        contour_residuals_mm(SQUARE + np.array([0.0, 0, 7.0]), cube), 2.0, atol=1e-12
    )


def test_resampling_sees_what_lies_between_the_points(sphere):
    # Corners on the sphere, sides inside of it by 20 (1 - cos 45 deg) in their middle.
    corners = 20.0 * np.array([[1.0, 0, 0], [0, 1, 0], [-1, 0, 0], [0, -1, 0]])
    assert contour_residuals_mm(corners, sphere).max() < 0.01
    between = contour_residuals_mm(corners, sphere, spacing_mm=0.1)
    assert between.max() == pytest.approx(20.0 * (1.0 - np.cos(np.pi / 4)), abs=0.05)
    assert len(between) == pytest.approx(4 * 20 * np.sqrt(2) / 0.1, abs=1)


def test_the_chord_of_an_open_outline_is_not_measured(cube):
    open_one = contour_residuals_mm(SQUARE * 0.8, cube, closed=False, spacing_mm=1.0)
    closed = contour_residuals_mm(SQUARE * 0.8, cube, spacing_mm=1.0)
    assert len(open_one) == 25  # three sides of 8 mm, both ends
    assert len(closed) == 32
