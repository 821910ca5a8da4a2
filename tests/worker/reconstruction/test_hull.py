"""The inflated hull: everything observed within, everything sampled on it or beyond."""

import numpy as np
import pytest

from schemas.problem import InputError, ProblemType
from worker.reconstruction import hull
from worker.reconstruction.hull import inflated_hull


@pytest.fixture
def cube() -> np.ndarray:
    return np.array([[x, y, z] for x in (-1, 1) for y in (-1, 1) for z in (-1, 1)], dtype=float)


def test_hull_of_a_cube_is_the_inflated_cube(cube: np.ndarray) -> None:
    hull = inflated_hull(cube, 1.2)
    on = hull.on_surface(500, np.random.default_rng(0))
    np.testing.assert_allclose(np.abs(on).max(axis=1), 1.2)
    beyond = hull.beyond(500, np.random.default_rng(0))
    assert (np.abs(beyond).max(axis=1) > 1.2).all()
    assert (beyond >= hull.lower).all()
    assert (beyond <= hull.upper).all()


def test_samples_are_spread_by_area(cube: np.ndarray) -> None:
    flat = cube * [1.0, 1.0, 0.01]
    on = inflated_hull(flat, 1.0).on_surface(4000, np.random.default_rng(1))
    top = np.abs(on[:, 2]) > 0.01 - 1e-9
    assert top.mean() == pytest.approx(8.0 / (8.0 + 4 * 2 * 0.02), abs=0.01)


def test_no_samples_asked_none_given(cube: np.ndarray) -> None:
    hull = inflated_hull(cube, 1.1)
    rng = np.random.default_rng(0)
    assert hull.on_surface(0, rng).shape == (0, 3)
    assert hull.beyond(0, rng).shape == (0, 3)


def test_points_in_a_plane_are_refused_with_the_remedy(cube: np.ndarray) -> None:
    with pytest.raises(InputError, match="add slices") as refused:
        inflated_hull(cube * [1.0, 1.0, 0.0], 1.1)
    assert refused.value.type is ProblemType.TOO_FEW_SLICES


def test_many_points_are_told_apart_in_blocks_as_at_once(
    cube: np.ndarray, monkeypatch: pytest.MonkeyPatch
) -> None:
    whole = inflated_hull(cube, 1.1).beyond(500, np.random.default_rng(0))
    monkeypatch.setattr(hull, "_PAIRS_AT_ONCE", 100)
    blocks = inflated_hull(cube, 1.1).beyond(500, np.random.default_rng(0))
    np.testing.assert_array_equal(whole, blocks)
