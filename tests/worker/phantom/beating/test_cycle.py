import numpy as np
import pytest

from schemas.problem import InputError
from worker.phantom.beating import CardiacCycle

RATES = [40.0, 60.0, 75.0, 110.0, 150.0]


@pytest.mark.parametrize("rate", RATES)
def test_every_beat_is_the_same(rate):
    cycle = CardiacCycle(rate)
    at = np.linspace(0.0, cycle.duration_ms, 997)
    for course in (cycle.contraction, cycle.twist):
        for beats in (-1, 1, 7):
            np.testing.assert_allclose(
                course(at + beats * cycle.duration_ms), course(at), rtol=0.0, atol=1e-12
            )


@pytest.mark.parametrize("rate", RATES)
def test_courses_go_on_smoothly_from_one_beat_to_the_next(rate):
    """Value, speed and acceleration: no jump larger than the step of the sampling explains."""
    cycle = CardiacCycle(rate)
    step_ms = 0.05
    at = np.arange(-20.0, 20.0, step_ms)
    for course in (cycle.contraction, cycle.twist):
        acceleration = np.diff(course(at), 2) / step_ms**2
        assert np.abs(acceleration).max() < 2e-3
        assert np.abs(np.diff(acceleration)).max() < 2e-5


@pytest.mark.parametrize("rate", RATES)
def test_the_ventricle_is_full_at_end_diastole_and_empty_at_end_systole(rate):
    cycle = CardiacCycle(rate)
    at = np.linspace(0.0, cycle.duration_ms, 5000)
    out = cycle.contraction(at)
    assert out[0] == 0.0
    assert out.min() >= -1e-12
    assert out.max() <= 1.0 + 1e-12
    for time_ms in (cycle.end_systole_ms, cycle.filling_ms):
        assert cycle.contraction(np.array([time_ms]))[0] == pytest.approx(1.0)
    systole = out[at <= cycle.end_systole_ms]
    diastole = out[at >= cycle.end_systole_ms]
    assert np.all(np.diff(systole) >= -1e-12)
    assert np.all(np.diff(diastole) <= 1e-12)


def test_at_rest_systole_is_a_third_and_the_atria_add_a_fifth_after_a_pause():
    cycle = CardiacCycle()
    assert cycle.duration_ms == 1000.0
    assert 0.30 < cycle.end_systole_ms / cycle.duration_ms < 0.38
    paused = cycle.contraction(np.linspace(cycle.diastasis_ms, cycle.kick_ms, 50))
    np.testing.assert_allclose(paused, 0.22, atol=1e-12)
    assert cycle.kick_ms - cycle.diastasis_ms > 200.0


def test_a_fast_heart_has_no_pause():
    cycle = CardiacCycle(120.0)
    assert cycle.diastasis_ms == pytest.approx(cycle.kick_ms)


def test_the_twist_is_greatest_at_end_systole_and_recoils_before_filling():
    cycle = CardiacCycle()
    at_end, at_filling, half_filled = cycle.twist(
        np.array([cycle.end_systole_ms, cycle.filling_ms, cycle.diastasis_ms])
    )
    assert at_end == 1.0
    assert 0.5 < at_filling < 0.7
    assert half_filled == pytest.approx(0.0, abs=1e-12)


def test_frames_are_even_and_do_not_repeat_end_diastole():
    times_ms = CardiacCycle(60.0).frame_times_ms(25)
    np.testing.assert_allclose(times_ms, 40.0 * np.arange(25))


@pytest.mark.parametrize("rate", [10.0, 300.0, float("nan")])
def test_rates_that_no_heart_has_are_refused(rate):
    with pytest.raises(InputError, match=r"heart_rate_bpm = .*between 40 and 150"):
        CardiacCycle(rate)
