import numpy as np
import pytest
import shapely

from worker.phantom.outline import enclosed_mm2, evenly_spaced, perimeter_mm, unsteady

Z = np.array([0.0, 0.0, 1.0])


def circle(radius: float, count: int) -> np.ndarray:
    angle = np.arange(count) * 2.0 * np.pi / count
    return radius * np.column_stack([np.cos(angle), np.sin(angle), np.zeros(count)])


def test_a_rectangle_is_measured_exactly():
    corners = np.array([[0.0, 0, 1], [4, 0, 1], [4, 3, 1], [0, 3, 1]])
    assert perimeter_mm(corners) == 14.0
    assert enclosed_mm2(corners) == 12.0


def test_points_are_evenly_spaced_and_on_the_line():
    uneven = circle(10.0, 4000)[np.sort(np.random.default_rng(0).permutation(4000)[:2000])]
    even = evenly_spaced(uneven, 1.0)
    gaps = np.linalg.norm(np.roll(even, -1, axis=0) - even, axis=1)
    assert len(even) == round(2 * np.pi * 10)
    np.testing.assert_allclose(gaps, 1.0, rtol=0.01)
    np.testing.assert_allclose(np.linalg.norm(even, axis=1), 10.0, atol=1e-3)


def test_a_small_loop_keeps_enough_points():
    assert len(evenly_spaced(circle(0.5, 100), 2.0)) == 8


def test_a_steady_hand_changes_nothing():
    loop = circle(20.0, 126)
    assert unsteady(loop, Z, 0.0, 10.0, np.random.default_rng(0)) is loop


def drawn_moves(count: int) -> np.ndarray:
    """(count, 251, 3) displacements of a circle of 40 mm radius by as many hands."""
    loop = circle(40.0, 251)
    return np.array(
        [unsteady(loop, Z, 0.5, 10.0, np.random.default_rng(s)) - loop for s in range(count)]
    )


def test_the_hand_is_as_unsteady_as_asked_and_stays_in_the_plane():
    moves = drawn_moves(200)
    assert np.all(moves[..., 2] == 0.0)
    np.testing.assert_allclose(moves[..., :2].std(axis=(0, 1)), 0.5, rtol=0.05)
    np.testing.assert_allclose(moves.mean(axis=(0, 1)), 0.0, atol=0.04)


def test_the_hand_is_smooth():
    moves = drawn_moves(100)[..., 0]

    def correlation(lag: int) -> float:
        return float(np.mean(moves * np.roll(moves, lag, axis=1)) / np.mean(moves**2))

    assert correlation(1) > 0.98
    assert correlation(10) == pytest.approx(np.exp(-1.0), abs=0.1)
    assert abs(correlation(60)) < 0.1


def test_corners_do_not_make_the_hand_cross_its_own_line():
    square = evenly_spaced(np.array([[0.0, 0, 0], [40, 0, 0], [40, 40, 0], [0, 40, 0]]), 1.0)
    for seed in range(50):
        drawn = unsteady(square, Z, 0.5, 10.0, np.random.default_rng(seed))
        assert shapely.Polygon(drawn[:, :2]).is_valid


def test_an_oblique_outline_stays_in_its_plane():
    normal = np.array([2.0, -1.0, 2.0]) / 3.0
    loop = circle(20.0, 126) @ np.linalg.svd(normal[None])[2][[1, 2, 0]]
    drawn = unsteady(loop, normal, 1.0, 10.0, np.random.default_rng(0))
    np.testing.assert_allclose(drawn @ normal, 0.0, atol=1e-12)
    assert np.abs(drawn - loop).max() > 0.5
