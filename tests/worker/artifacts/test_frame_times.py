import pytest

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
