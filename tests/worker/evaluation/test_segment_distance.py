"""Distances to the sides of a square."""

import numpy as np
from hypothesis import given, settings
from hypothesis import strategies as st

from worker.evaluation.segment_distance import distance_to_segments_mm, ring_segments

SQUARE = np.array([[0.0, 0, 0], [10, 0, 0], [10, 10, 0], [0, 10, 0]])


def test_a_ring_is_closed() -> None:
    assert ring_segments(3).tolist() == [[0, 1], [1, 2], [2, 0]]


def test_distances_are_to_sides_and_not_to_corners() -> None:
    points = np.array([[5.0, 5, 0], [5, -2, 0], [-3, -4, 0], [0, 5, 0], [5, 0, 7]])
    closed = distance_to_segments_mm(points, SQUARE, ring_segments(4))
    np.testing.assert_allclose(closed, [5.0, 2.0, 5.0, 0.0, 7.0], atol=1e-12)
    without_the_last = distance_to_segments_mm(points, SQUARE, ring_segments(4)[:-1])
    assert without_the_last[3] == 5.0


@settings(deadline=None)
@given(st.lists(st.floats(-50.0, 50.0), min_size=3, max_size=3))
def test_distances_are_those_of_the_formula(point: list[float]) -> None:
    def to_side(start: np.ndarray, end: np.ndarray) -> float:
        along = np.clip((point - start) @ (end - start) / 100.0, 0.0, 1.0)
        return float(np.linalg.norm(point - start - along * (end - start)))

    expected = min(to_side(a, b) for a, b in zip(SQUARE, np.roll(SQUARE, -1, axis=0), strict=True))
    (found,) = distance_to_segments_mm(np.array([point]), SQUARE, ring_segments(4))
    np.testing.assert_allclose(found, expected, atol=1e-9)
