"""Points of a curve are put in the order of the curve, and pieces into one outline."""

import numpy as np
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st

from intake.formats.outline_joining import join
from intake.formats.outline_path import in_order, typical_step
from intake.formats.outline_runs import runs_of
from intake.study import MAX_WARNINGS
from schemas.messages import MOST_WARNINGS
from tests.intake.formats.guide_point_files import arc


def length(points: np.ndarray) -> float:
    return float(np.linalg.norm(np.diff(points, axis=0), axis=1).sum())


@settings(max_examples=40, deadline=None)
@given(st.integers(0, 2**32 - 1), st.integers(16, 120), st.floats(30.0, 340.0))
def test_a_shuffled_arc_is_told_from_end_to_end(seed: int, n: int, degrees: float) -> None:
    points = arc((3, -2), 25, 0, degrees, n)
    order = np.random.default_rng(seed).permutation(n)
    found = order[in_order(points[order])]
    assert found.tolist() in (list(range(n)), list(range(n - 1, -1, -1))) or (
        # Close to a ring the gap is no longer than a step: it may be cut anywhere.
        length(points[found]) <= length(points) * 1.1
    )


def test_points_in_order_stay_as_they_are() -> None:
    points = arc((0, 0), 10, 0, 300, 50)
    assert in_order(points).tolist() == list(range(50))
    assert typical_step(points) == pytest.approx(length(points) / 49)


@given(st.permutations(range(4)), st.lists(st.booleans(), min_size=4, max_size=4))
def test_pieces_make_one_outline_in_whatever_order_and_direction(
    order: list[int], turned: list[bool]
) -> None:
    pieces = [arc((0, 0), 10, 85 * k, 85 * k + 80, 12) for k in range(4)]
    told = [pieces[k][::-1] if turn else pieces[k] for k, turn in zip(order, turned, strict=True)]
    joined = join(told)
    # Four arcs of 80 degrees, three joints of 5, and what is left open: 25.
    assert joined.opening == pytest.approx(20 * np.sin(np.deg2rad(12.5)))
    assert joined.longest_joint == pytest.approx(20 * np.sin(np.deg2rad(2.5)))
    whole = np.concatenate(pieces)
    assert np.allclose(joined.points, whole) or np.allclose(joined.points[::-1], whole)


def test_more_pieces_than_can_be_tried_are_joined_by_the_nearest_ends() -> None:
    pieces = [arc((0, 0), 10, 40 * k, 40 * k + 35, 8) for k in range(8)]
    joined = join([pieces[k] for k in (3, 0, 6, 1, 7, 2, 5, 4)])
    assert joined.longest_joint == pytest.approx(20 * np.sin(np.deg2rad(2.5)))


def test_an_opening_is_where_a_valve_marks_it() -> None:
    left, right = arc((0, 0), 10, 20, 170, 40), arc((0, 0), 10, 195, 345, 40)
    # The joints: 25 degrees about 182.5, 35 about 2.5.
    assert join([left, right]).opening == pytest.approx(20 * np.sin(np.deg2rad(17.5)))
    marked = join([left, right], np.array([[-10.0, 0.0]]))
    assert marked.opening == pytest.approx(20 * np.sin(np.deg2rad(12.5)))


def test_a_piece_told_from_its_middle_is_one_run() -> None:
    points = arc((0, 0), 10, 0, 180, 40)
    assert len(runs_of(np.concatenate([points[20:], points[:20]])).runs) == 1


def test_repeats_and_spikes_are_no_points_of_a_run() -> None:
    points = arc((0, 0), 10, 0, 300, 60)
    spoiled = np.concatenate([points[:30], points[29:30], [[60.0, 0.0]], points[30:], points[:1]])
    found = runs_of(spoiled)
    assert found.spikes == 1
    assert sum(map(len, found.runs)) == 60


def test_as_many_warnings_may_come_with_a_study_as_reading_gives() -> None:
    assert MOST_WARNINGS == MAX_WARNINGS + 1
