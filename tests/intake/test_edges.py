"""Edges of many rings in one array, and their runs."""

import numpy as np
import pytest

from intake.edges import batches, edges_of, order_along


def test_every_ring_is_closed_upon_itself() -> None:
    rings = [np.arange(6.0).reshape(3, 2), np.array([[7.0, 7.0]]), np.ones((4, 2))]
    edges = edges_of(rings)
    assert edges.ring.tolist() == [0] * 3 + [1] + [2] * 4
    for number, ring in enumerate(rings):
        at = edges.ring == number
        np.testing.assert_array_equal(edges.start[at], ring)
        np.testing.assert_array_equal(edges.end[at], np.roll(ring, -1, axis=0))


@pytest.mark.parametrize("most", [1, 5, 10, 100])
def test_runs_share_out_everything_and_stay_small(most: int) -> None:
    sizes = [3, 1, 4, 1, 5, 9, 2, 6]
    runs = batches(sizes, most)
    assert [n for run in runs for n in range(len(sizes))[run]] == list(range(len(sizes)))
    assert all(sum(sizes[run]) <= most or run.stop - run.start == 1 for run in runs)


def test_nothing_is_no_run() -> None:
    assert batches([], 10) == []


def test_the_order_is_by_line_and_then_along_it() -> None:
    rng = np.random.default_rng(0)
    line, x = rng.integers(0, 50, 1000), rng.normal(size=1000) * 100.0
    assert order_along(line, x).tolist() == np.lexsort((x, line)).tolist()
    same = np.zeros(3)
    assert sorted(order_along(np.array([2, 0, 1]), same).tolist()) == [0, 1, 2]
    assert len(order_along(line[:0], x[:0])) == 0
