import pytest

from schemas.frame_report import StudyFrame
from tests.worker.artifacts.page.example_report import frame_report
from worker.artifacts.frame_times import FrameTimes, frame_times


def times_of(*times_ms: float | None, is_whole_cycle: bool = True) -> FrameTimes:
    frames = [frame_report(f"F{n}", time_ms=time) for n, time in enumerate(times_ms)]
    return frame_times(frames, is_whole_cycle=is_whole_cycle)


def test_frames_are_in_the_order_of_time_and_the_cycle_ends_a_step_after_the_last() -> None:
    times = times_of(100.0, 180.0, 140.0, 220.0)
    assert times.labels == ("F0", "F2", "F1", "F3")
    assert (times.unit, times.steps) == ("ms", (100.0, 140.0, 180.0, 220.0))
    assert times.seconds == pytest.approx((0.0, 0.04, 0.08, 0.12))
    assert times.period_s == pytest.approx(0.16)


def test_later_by_any_time_plays_the_same() -> None:
    early, late = times_of(0.0, 30.0, 90.0), times_of(500.0, 530.0, 590.0)
    assert early.seconds == late.seconds
    assert early.period_s == late.period_s


@pytest.mark.parametrize("times_ms", [(None, None, None, None), (0.0, None, 2.0, 3.0), (0.0,) * 4])
def test_without_a_time_for_each_a_cycle_takes_a_second(times_ms: tuple[float | None, ...]) -> None:
    times = times_of(*times_ms)
    assert times.labels == ("F0", "F1", "F2", "F3")
    assert (times.unit, times.steps) == ("frame index", (0.0, 1.0, 2.0, 3.0))
    assert times.seconds == (0.0, 0.25, 0.5, 0.75)
    assert times.period_s == 1.0


def with_gaps(
    there: tuple[int, ...], *times_ms: float | None, is_whole_cycle: bool = True
) -> FrameTimes:
    study = [StudyFrame(label=f"F{n}", time_ms=time) for n, time in enumerate(times_ms)]
    frames = [frame_report(study[n].label, time_ms=study[n].time_ms) for n in there]
    return frame_times(frames, study, is_whole_cycle=is_whole_cycle)


EVEN = tuple(40.0 * n for n in range(6))


@pytest.mark.parametrize("there", [(0, 1, 2, 3, 5), (1, 2, 4), (0, 1, 2), (3, 4, 5)])
def test_the_period_is_that_of_the_study_whatever_frames_failed(there: tuple[int, ...]) -> None:
    times = with_gaps(there, *EVEN)
    assert times.period_ms == pytest.approx(240.0)
    assert times.period_s == pytest.approx(0.24)
    assert times.steps == tuple(40.0 * n for n in there)


def test_what_is_no_whole_cycle_has_no_period_and_plays_a_step_longer_than_it_is() -> None:
    times = with_gaps((0, 1, 3), *EVEN, is_whole_cycle=False)
    assert times.period_ms is None
    assert times.period_s == pytest.approx(0.16)


def test_without_times_a_frame_keeps_its_place_in_the_study() -> None:
    times = with_gaps((0, 1, 4), *(None,) * 6)
    assert times.steps == (0.0, 1.0, 4.0)
    assert times.seconds == pytest.approx((0.0, 1.0 / 6.0, 4.0 / 6.0))


def test_numbers_are_put_where_their_frames_are_in_the_study() -> None:
    assert with_gaps((0, 1, 4), *EVEN).by_place([1.0, None, 3.0]) == [1.0, *[None] * 3, 3.0, None]


def test_a_step_that_is_too_long_is_a_place_to_spare() -> None:
    times = times_of(0.0, 40.0, 80.0, 160.0, 200.0)
    assert times.by_place([1.0, 2.0, 3.0, 4.0, 5.0]) == [1.0, 2.0, 3.0, None, 4.0, 5.0]
    assert times_of(0.0, 40.0, 80.0, 139.0).count == 4
