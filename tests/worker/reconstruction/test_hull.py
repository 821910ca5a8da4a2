"""The inflated hull: everything observed within, everything sampled on it or beyond."""

import numpy as np
import pytest
from scipy.spatial import ConvexHull

from schemas.problem import InputError, ProblemType
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


@pytest.fixture
def egg() -> np.ndarray:
    """Points of an ellipsoid with semi-axes 1, 0.7 and 0.5."""
    directions = np.random.default_rng(3).normal(size=(600, 3))
    directions /= np.linalg.norm(directions, axis=1, keepdims=True)
    return directions * [1.0, 0.7, 0.5]


@pytest.mark.parametrize("seed", [0, 1])
def test_beyond_is_clear_of_the_hull_and_comes_close_to_it(egg: np.ndarray, seed: int) -> None:
    beyond = inflated_hull(egg, 1.1).beyond(4000, np.random.default_rng(seed))
    assert len(beyond) == 4000
    faces = ConvexHull(1.1 * egg + (1.0 - 1.1) * egg.mean(axis=0)).equations
    assert ((beyond @ faces[:, :3].T + faces[:, 3]).max(axis=1) > 0.0).all()
    sizes = np.linalg.norm((beyond - egg.mean(axis=0)) / [1.0, 0.7, 0.5], axis=1)
    assert sizes.min() < 1.1 * 1.03


def test_beyond_fills_the_box_evenly(egg: np.ndarray) -> None:
    hull = inflated_hull(egg, 1.1)
    beyond = hull.beyond(20000, np.random.default_rng(2))
    assert (beyond >= hull.lower).all()
    assert (beyond <= hull.upper).all()
    np.testing.assert_allclose(hull.upper - 1.1 * egg.max(axis=0), 0.06, atol=0.01)
    middle = 0.5 * (hull.lower + hull.upper)
    octants = ((beyond > middle) @ [1, 2, 4]).astype(int)
    np.testing.assert_allclose(np.bincount(octants) / len(beyond), 0.125, atol=0.02)


def test_a_hull_is_no_larger_for_points_within_it(egg: np.ndarray) -> None:
    inner = np.concatenate([egg - egg.mean(axis=0), 0.5 * (egg - egg.mean(axis=0))])
    full = inflated_hull(egg - egg.mean(axis=0), 1.1)
    np.testing.assert_allclose(inflated_hull(inner, 1.1).reach, full.reach)
