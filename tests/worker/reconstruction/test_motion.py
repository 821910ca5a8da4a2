"""Moving back undoes a turn about the pivot and then a shift."""

import numpy as np
import pytest
from scipy.spatial.transform import Rotation

from worker.reconstruction.motion import moved_back


@pytest.fixture
def points() -> np.ndarray:
    return np.random.default_rng(0).normal(size=(40, 3))


@pytest.mark.parametrize("turn", [-0.3, 0.0, 1e-3, 0.2, 3.0])
def test_it_is_the_inverse_of_a_turn_and_a_shift(points: np.ndarray, turn: float) -> None:
    rng = np.random.default_rng(1)
    normal = rng.normal(size=3)
    normal /= np.linalg.norm(normal)
    pivot, shift = rng.normal(size=(2, 3))
    drawn = Rotation.from_rotvec(turn * normal).apply(points + shift - pivot) + pivot
    np.testing.assert_allclose(moved_back(drawn, shift, turn, pivot, normal), points, atol=1e-12)


def test_nothing_moves_at_zero(points: np.ndarray) -> None:
    zero, normal = np.zeros(3), np.array([0.0, 0.0, 1.0])
    np.testing.assert_array_equal(moved_back(points, zero, 0.0, points[0], normal), points)


def test_a_quarter_turn_is_right_handed(points: np.ndarray) -> None:
    zero, normal = np.zeros(3), np.array([0.0, 0.0, 1.0])
    back = moved_back(points, zero, np.pi / 2, zero, normal)
    np.testing.assert_allclose(back, points[:, [1, 0, 2]] * [1.0, -1.0, 1.0], atol=1e-12)
