"""Every frame has one turn, after those that it goes on from, and never far from the first."""

import pytest
from hypothesis import given
from hypothesis import strategies as st

from worker.reconstruction.cycle import FitStep, after_largest_gap, chains, fit_order, in_time


@given(st.integers(1, 40), st.data(), st.booleans())
def test_every_frame_has_its_turn_after_those_it_goes_on_from(
    count: int, data: st.DataObject, whole_cycle: bool
) -> None:
    first = data.draw(st.integers(0, count - 1))
    steps = fit_order(first, count, whole_cycle=whole_cycle)
    assert steps[0].frame == first
    assert sorted(step.frame for step in steps) == list(range(count))
    done = set()
    for step in steps:
        assert done >= set(step.before)
        done.add(step.frame)
    for step in steps[1:]:
        assert step.before[-1] == first
        away = abs(step.before[0] - step.frame)
        assert away == 1 or (whole_cycle and away == count - 1)


def test_chains_meet_half_way_round_a_whole_cycle() -> None:
    steps = fit_order(3, 25, whole_cycle=True)
    assert max(len(step.before) for step in steps) == 12
    assert (steps[1].frame, steps[1].before) == (4, (3,))
    assert {step.frame for step in steps if len(step.before) == 12} == {15, 16}


def test_chains_run_to_the_ends_of_a_part_of_a_cycle() -> None:
    steps = {step.frame: step.before for step in fit_order(1, 4, whole_cycle=False)}
    assert steps == {1: (), 2: (1,), 3: (2, 1), 0: (1,)}


@pytest.mark.parametrize(
    ("times_ms", "order"),
    [
        ([40.0, 0.0, 20.0], [1, 2, 0]),
        ([40.0, None, 20.0], [0, 1, 2]),
        ([None], [0]),
        ([], []),
    ],
)
def test_frames_are_in_the_order_of_their_times_where_all_have_one(
    times_ms: list[float | None], order: list[int]
) -> None:
    assert in_time(times_ms) == order


def test_both_ways_round_are_chains_of_their_own() -> None:
    steps = fit_order(3, 25, whole_cycle=True)
    forward, backward = chains(steps[1:])
    assert [step.frame for step in forward] == list(range(4, 16))
    assert [step.frame for step in backward] == [*range(2, -1, -1), *range(24, 15, -1)]


def test_frames_that_need_no_other_are_chains_of_one() -> None:
    alone = [FitStep(frame, ()) for frame in range(3)]
    assert chains(alone) == [(step,) for step in alone]


@pytest.mark.parametrize(
    ("places", "count", "first"),
    [
        ([0, 1, 24], 25, 2),
        ([0, 1, 2, 22, 23, 24], 25, 3),
        ([10, 11, 12], 25, 0),
        ([0, 2, 3, 5], 6, 1),
        ([0, 1, 2], 3, 0),
        ([4], 9, 0),
    ],
)
def test_what_is_left_of_a_cycle_begins_after_the_longest_gap(
    places: list[int], count: int, first: int
) -> None:
    assert after_largest_gap(places, count) == first


@given(st.sets(st.integers(0, 24), min_size=1))
def test_in_that_order_the_frames_span_as_little_of_the_cycle_as_can_be(there: set[int]) -> None:
    places = sorted(there)

    def span(first: int) -> int:
        return (places[first - 1] - places[first]) % 25

    assert span(after_largest_gap(places, 25)) == min(map(span, range(len(places))))
