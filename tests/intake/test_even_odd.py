"""Even-odd fill against shapely, and its laws."""

import numpy as np
import pytest
import shapely
from numpy.typing import NDArray

from intake.even_odd import inside

Array = NDArray[np.float64]

SQUARE = np.array([[0.0, 0.0], [1.0, 0.0], [1.0, 1.0], [0.0, 1.0]])


def wavy(points: int, lobes: int, radius: float = 30.0) -> Array:
    t = np.linspace(0, 2 * np.pi, points, endpoint=False)
    r = radius * (1 + 0.3 * np.sin(lobes * t))
    return np.c_[r * np.cos(t), r * np.sin(t)]


@pytest.mark.parametrize(("points", "lobes"), [(3, 0), (12, 2), (200, 3), (800, 7), (5000, 40)])
def test_agrees_with_shapely(points: int, lobes: int) -> None:
    ring = wavy(points, lobes)
    at = np.random.default_rng(points).uniform(-45, 45, (5000, 2))
    expected = shapely.contains_xy(shapely.Polygon(ring), at[:, 0], at[:, 1])
    np.testing.assert_array_equal(inside(at, [ring]), expected)


def test_agrees_with_shapely_on_a_hole_and_a_second_part() -> None:
    outer, hole, apart = wavy(100, 3), wavy(50, 2, 10.0), np.add(wavy(60, 0, 8.0), (60.0, 5.0))
    shape = shapely.MultiPolygon([(outer, [hole]), (apart, [])])
    at = np.random.default_rng(1).uniform(-45, 75, (5000, 2))
    expected = shapely.contains_xy(shape, at[:, 0], at[:, 1])
    np.testing.assert_array_equal(inside(at, [outer, hole, apart]), expected)


def test_direction_start_and_a_repeated_first_point_change_nothing() -> None:
    ring = wavy(150, 5)
    at = np.random.default_rng(2).uniform(-45, 45, (2000, 2))
    expected = inside(at, [ring])
    for same in (ring[::-1], np.roll(ring, 37, axis=0), np.r_[ring, ring[:1]]):
        np.testing.assert_array_equal(inside(at, [same]), expected)


def test_a_ring_twice_is_nothing() -> None:
    at = np.random.default_rng(3).uniform(-45, 45, (2000, 2))
    assert not inside(at, [wavy(80, 3), wavy(80, 3)]).any()


def test_left_and_lower_edges_are_inside_right_and_upper_outside() -> None:
    at = np.array([[0.0, 0.5], [0.5, 0.0], [0.0, 0.0], [1.0, 0.5], [0.5, 1.0], [1.0, 1.0]])
    assert inside(at, [SQUARE]).tolist() == [True, True, True, False, False, False]


def test_tiles_share_out_every_point_once() -> None:
    tiles = [np.add(SQUARE, (i, j)) for i in range(3) for j in range(3)]
    grid = np.stack(np.meshgrid(np.arange(0, 3, 0.25), np.arange(0, 3, 0.25)), axis=-1)
    owners = sum(inside(grid.reshape(-1, 2), [tile]).astype(int) for tile in tiles)
    np.testing.assert_array_equal(owners, 1)


def test_nothing_is_inside_no_ring_and_no_points_are_no_answer() -> None:
    assert not inside(SQUARE, []).any()
    assert inside(np.empty((0, 2)), [SQUARE]).shape == (0,)


def test_nearly_level_edges_do_not_overflow() -> None:
    sliver = np.array([[0.0, 0.0], [1e7, 5e-324], [1e7, 1.0], [0.0, 1.0]])
    # The lower edge rises from its first point, so the second point is below it.
    assert inside(np.array([[5.0, 0.5], [5.0, 0.0]]), [sliver]).tolist() == [True, False]


def test_an_outline_of_long_edges_is_taken_in_blocks() -> None:
    """5000 edges that every one of 5000 points sees: 25 million pairs, never at once."""
    x = np.arange(2500.0)
    zigzag = np.stack([np.c_[x, np.zeros(2500)], np.c_[x + 0.5, np.ones(2500)]], axis=1)
    ring = np.r_[zigzag.reshape(-1, 2), [[2500.0, -1.0], [-1.0, -1.0]]]
    at = np.random.default_rng(4).uniform((0, 0.01), (2499, 0.99), (5000, 2))
    expected = shapely.contains_xy(shapely.Polygon(ring), at[:, 0], at[:, 1])
    np.testing.assert_array_equal(inside(at, [ring]), expected)
