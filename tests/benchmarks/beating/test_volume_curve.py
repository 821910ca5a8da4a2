"""Volumes over a cycle: what is known of curves whose numbers are known."""

import pytest

from benchmarks.beating.volume_curve import differences_ml, pump


def test_a_pump_is_of_the_largest_and_the_smallest_volume() -> None:
    found = pump([90.0, 100.0, None, 40.0])
    assert found is not None
    assert (found.edv_ml, found.esv_ml) == (100.0, 40.0)
    assert found.ejection_fraction_percent == pytest.approx(60.0)
    assert pump([None, None]) is None


def test_differences_are_frame_by_frame() -> None:
    assert differences_ml([3.0, None, 5.0], [1.0, 2.0, None]) == [2.0, None, None]
