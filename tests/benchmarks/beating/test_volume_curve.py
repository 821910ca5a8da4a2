"""Volumes over a cycle: what is known of curves whose numbers are known."""

import numpy as np
import pytest

from benchmarks.beating.volume_curve import differences_ml, jitter_ml, pump


def test_a_straight_curve_has_no_jitter_and_a_parabola_that_of_its_bend() -> None:
    steps = np.arange(25.0)
    straight, bent = 100.0 - 2.0 * steps, 100.0 - 1.5 * steps**2
    assert jitter_ml(straight.tolist(), is_whole_cycle=False) == pytest.approx(0.0, abs=1e-12)
    # Its second difference is twice the coefficient at every frame.
    assert jitter_ml(bent.tolist(), is_whole_cycle=False) == pytest.approx(3.0 / 6.0**0.5)


def test_independent_errors_of_one_ml_are_a_jitter_of_one() -> None:
    shaken = 100.0 + np.random.default_rng(0).normal(size=20_000)
    assert jitter_ml(shaken.tolist()) == pytest.approx(1.0, rel=0.02)


def test_of_a_whole_cycle_it_does_not_matter_which_frame_is_the_first() -> None:
    curve = [100.0, 80.0, 50.0, 45.0, 70.0, 95.0]
    for first in range(len(curve)):
        assert jitter_ml(curve[first:] + curve[:first]) == pytest.approx(jitter_ml(curve))


def test_a_curve_with_a_gap_has_no_jitter() -> None:
    assert jitter_ml([100.0, None, 50.0, 60.0]) is None
    assert jitter_ml([100.0, 50.0]) is None


def test_a_pump_is_of_the_largest_and_the_smallest_volume() -> None:
    found = pump([90.0, 100.0, None, 40.0])
    assert found is not None
    assert (found.edv_ml, found.esv_ml) == (100.0, 40.0)
    assert found.ejection_fraction_percent == pytest.approx(60.0)
    assert pump([None, None]) is None


def test_differences_are_frame_by_frame() -> None:
    assert differences_ml([3.0, None, 5.0], [1.0, 2.0, None]) == [2.0, None, None]
