"""Crossing edges against a look at every pair."""

from itertools import pairwise

import numpy as np
import pytest
import shapely

from intake.crossing_edges import crossing_edges


def circle(n: int) -> np.ndarray:
    t = np.linspace(0, 2 * np.pi, n, endpoint=False)
    return np.c_[np.cos(t), np.sin(t)] * 30


@pytest.mark.parametrize("closed", [True, False])
@pytest.mark.parametrize("seed", range(5))
def test_finds_what_shapely_finds(seed: int, closed: bool) -> None:
    points = np.random.default_rng(seed).normal(size=(40, 2))
    ends = np.r_[points, points[:1]] if closed else points
    edges = [shapely.LineString(pair) for pair in pairwise(ends)]
    expected = {
        (i, j)
        for i in range(len(edges))
        for j in range(i + 1, len(edges))
        if shapely.crosses(edges[i], edges[j])
    }
    found = crossing_edges([(points, closed)])[0]
    assert found is not None
    assert set(zip(*(f.tolist() for f in found), strict=True)) == expected


@pytest.mark.parametrize("n", [3, 40, 5000])
def test_a_circle_crosses_nowhere(n: int) -> None:
    found = crossing_edges([(circle(n), True)])[0]
    assert found is not None
    assert len(found[0]) == 0


def test_touching_and_going_back_over_a_line_is_no_crossing() -> None:
    """A pixel outline with a spike one pixel wide."""
    spike = np.array([[0, 0], [4, 0], [4, 4], [2, 4], [2, 7], [2, 4], [0, 4]], dtype=float)
    found = crossing_edges([(spike, True)])[0]
    assert found is not None
    assert len(found[0]) == 0


def test_a_long_staircase_of_level_edges_is_cheap() -> None:
    side = np.arange(1250.0)
    zero, full = np.zeros(1250), np.full(1250, 1250.0)
    square = np.r_[
        np.c_[side, zero], np.c_[full, side], np.c_[1250 - side, full], np.c_[zero, 1250 - side]
    ]
    found = crossing_edges([(square, True)])[0]
    assert found is not None
    assert len(found[0]) == 0


def test_a_tangle_is_given_up() -> None:
    points = np.random.default_rng(0).normal(size=(5000, 2))
    assert crossing_edges([(points, True)]) == [None]


def test_many_outlines_are_searched_as_each_alone() -> None:
    rng = np.random.default_rng(1)
    tangle = rng.normal(size=(3000, 2))
    outlines = [(circle(40), True), (tangle, True)]
    outlines += [(rng.normal(size=(n, 2)) + 100.0 * n, n % 2 == 0) for n in range(3, 40)]
    together = crossing_edges(outlines)
    assert together[1] is None
    for outline, found in zip(outlines, together, strict=True):
        (alone,) = crossing_edges([outline])
        if alone is None or found is None:
            assert alone is found
            continue
        assert set(zip(*map(np.ndarray.tolist, found), strict=True)) == set(
            zip(*map(np.ndarray.tolist, alone), strict=True)
        )
