import pytest

from worker.evaluation.change import change_percent, shortening_percent


def test_change_is_none_at_its_own_frame_and_needs_no_unit() -> None:
    series = [80.0, 100.0, None, 60.0]
    found = change_percent(series, 1)
    assert found == pytest.approx([-20.0, 0.0, None, -40.0])
    assert change_percent([one and 10.0 * one for one in series], 1) == pytest.approx(found)
    assert shortening_percent(series, 1) == pytest.approx([20.0, 0.0, None, 40.0])


@pytest.mark.parametrize("first", [None, 0.0])
def test_nothing_is_measured_from_nothing(first: float | None) -> None:
    assert change_percent([first, 4.0], 0) == [None, None]
    assert shortening_percent([first, 4.0], 0) == [None, None]
