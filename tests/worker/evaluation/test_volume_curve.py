"""Rates of volume curves with a formula, and of the beating phantom's."""

import numpy as np
import pytest

from schemas.vocabulary import Structure
from worker.evaluation.volume_curve import peak_rates, period_ms
from worker.phantom.beating import Beat, BeatingHeart, CardiacCycle

PERIOD_MS = 800.0


def times_ms(count: int) -> np.ndarray:
    return np.arange(count) * PERIOD_MS / count


def beat_ml(at_ms: np.ndarray) -> np.ndarray:
    """Empties faster than it fills."""
    turn = 2.0 * np.pi * at_ms / PERIOD_MS
    return 100.0 + 30.0 * np.cos(turn) - 8.0 * np.sin(2.0 * turn)


def steepest_ml_per_s(volumes_ml: np.ndarray, at_ms: np.ndarray) -> tuple[float, float]:
    slopes = np.gradient(volumes_ml, at_ms) * 1000.0
    return -slopes.min(), slopes.max()


@pytest.fixture
def fine_ms() -> np.ndarray:
    return np.linspace(0.0, PERIOD_MS, 20_001)


def test_a_whole_cycle_has_its_formulas_slopes(fine_ms: np.ndarray) -> None:
    found = peak_rates(beat_ml(times_ms(20)), times_ms(20), PERIOD_MS)
    assert found is not None
    fall, rise = steepest_ml_per_s(beat_ml(fine_ms), fine_ms)
    assert found.ejection_ml_per_s == pytest.approx(fall, rel=2e-3)
    assert found.filling_ml_per_s == pytest.approx(rise, rel=2e-3)
    assert fall != pytest.approx(rise, rel=0.1)


def test_a_beating_spheres_rates() -> None:
    """r = r0 (1 - a sin2): V' = -3 V0 (1 - a s)2 a s', steepest where its own slope is none."""
    at_ms = times_ms(24)
    part = 0.3
    small = np.sin(np.pi * at_ms / PERIOD_MS) ** 2
    found = peak_rates(120.0 * (1.0 - part * small) ** 3, at_ms, PERIOD_MS)
    fine = np.linspace(0.0, 0.5, 100_001)
    s, slope = np.sin(np.pi * fine) ** 2, np.pi * np.sin(2.0 * np.pi * fine)
    rate = (3.0 * 120.0 * (1.0 - part * s) ** 2 * part * slope).max() / PERIOD_MS * 1000.0
    assert found is not None
    assert found.ejection_ml_per_s == pytest.approx(rate, rel=1e-3)
    assert found.filling_ml_per_s == pytest.approx(rate, rel=1e-3)


@pytest.mark.parametrize("count", [12, 25, 40])
def test_turning_time_back_swaps_ejection_and_filling(count: int) -> None:
    volumes_ml = beat_ml(times_ms(count))
    there = peak_rates(volumes_ml, times_ms(count), PERIOD_MS)
    back = peak_rates(volumes_ml[::-1], times_ms(count), PERIOD_MS)
    assert there is not None
    assert back is not None
    assert there.ejection_ml_per_s == pytest.approx(back.filling_ml_per_s)
    assert there.filling_ml_per_s == pytest.approx(back.ejection_ml_per_s)


@pytest.mark.parametrize("count", [12, 25, 40])
@pytest.mark.parametrize("frames", [1, 7])
def test_where_in_a_whole_cycle_frames_begin_changes_nothing(count: int, frames: int) -> None:
    rng = np.random.default_rng(0)
    volumes_ml = beat_ml(times_ms(count)) + rng.normal(size=count)
    whole = peak_rates(volumes_ml, times_ms(count), PERIOD_MS)
    moved = peak_rates(np.roll(volumes_ml, frames), times_ms(count) + 55.0, PERIOD_MS)
    assert whole is not None
    assert moved is not None
    assert moved.ejection_ml_per_s == pytest.approx(whole.ejection_ml_per_s)
    assert moved.filling_ml_per_s == pytest.approx(whole.filling_ml_per_s)


def test_rates_scale_with_volume_and_against_time() -> None:
    volumes_ml = beat_ml(times_ms(25))
    one = peak_rates(volumes_ml, times_ms(25), PERIOD_MS)
    other = peak_rates(3.0 * volumes_ml, 2.0 * times_ms(25), 2.0 * PERIOD_MS)
    assert one is not None
    assert other is not None
    assert other.ejection_ml_per_s == pytest.approx(1.5 * one.ejection_ml_per_s)
    assert other.filling_ml_per_s == pytest.approx(1.5 * one.filling_ml_per_s)


def test_part_of_a_cycle_does_not_close() -> None:
    """A parabola is followed exactly, its slope steepest at its ends."""
    at_ms = np.array([0.0, 20.0, 50.0, 100.0])
    found = peak_rates(80.0 - 0.6 * at_ms + 0.002 * at_ms**2, at_ms)
    assert found is not None
    assert found.ejection_ml_per_s == pytest.approx(600.0)
    assert found.filling_ml_per_s == 0.0


def test_frames_may_be_missing(fine_ms: np.ndarray) -> None:
    kept = np.delete(np.arange(30), [4, 19])
    at_ms = times_ms(30)[kept]
    found = peak_rates(beat_ml(at_ms), at_ms, PERIOD_MS)
    assert found is not None
    fall, rise = steepest_ml_per_s(beat_ml(fine_ms), fine_ms)
    assert found.ejection_ml_per_s == pytest.approx(fall, rel=2e-3)
    assert found.filling_ml_per_s == pytest.approx(rise, rel=2e-3)
    assert period_ms(at_ms) == pytest.approx(PERIOD_MS)


@pytest.mark.parametrize("bad", [[0.0, 40.0], [0.0, 40.0, 40.0], [0.0, 40.0, 30.0]])
def test_no_rates_of_two_frames_or_of_times_that_do_not_grow(bad: list[float]) -> None:
    assert peak_rates(np.linspace(90.0, 60.0, len(bad)), np.array(bad)) is None


def test_a_still_volume_has_no_rate() -> None:
    found = peak_rates(np.full(25, 70.0), times_ms(25), PERIOD_MS)
    assert found is not None
    assert found.ejection_ml_per_s == pytest.approx(0.0, abs=1e-9)
    assert found.filling_ml_per_s == pytest.approx(0.0, abs=1e-9)


@pytest.mark.parametrize("bpm", [40.0, 60.0, 100.0])
@pytest.mark.parametrize(("count", "noise_ml", "percent"), [(25, 0.0, 5.0), (25, 0.5, 10.0)])
def test_the_beating_phantoms_rates(
    bpm: float, count: int, noise_ml: float, percent: float
) -> None:
    """Root mean square of the error over 40 draws; docs/method.md has the table."""
    heart = BeatingHeart(beat=Beat(cycle=CardiacCycle(bpm)))
    duration_ms = heart.beat.cycle.duration_ms
    fine_ms = np.linspace(0.0, duration_ms, 10_001)
    true = steepest_ml_per_s(heart.lv_volumes_ml(fine_ms)[Structure.LV_ENDO], fine_ms)
    at_ms = heart.beat.cycle.frame_times_ms(count)
    volumes_ml = heart.lv_volumes_ml(at_ms)[Structure.LV_ENDO]
    assert period_ms(at_ms) == pytest.approx(duration_ms)
    rng = np.random.default_rng(0)
    errors = []
    for _ in range(40):
        found = peak_rates(volumes_ml + noise_ml * rng.normal(size=count), at_ms, duration_ms)
        assert found is not None
        rates = np.array([found.ejection_ml_per_s, found.filling_ml_per_s])
        errors.append(100.0 * (rates / true - 1.0))
    assert np.sqrt((np.array(errors) ** 2).mean(axis=0)).max() < percent


def test_many_frames_are_not_taken_for_many_waves() -> None:
    """With 40 frames a curve through all of them would make 2 mL of noise a rate of its own."""
    rng = np.random.default_rng(0)
    rates = [
        peak_rates(70.0 + 2.0 * rng.normal(size=40), times_ms(40), PERIOD_MS) for _ in range(20)
    ]
    few = [peak_rates(70.0 + 2.0 * rng.normal(size=20), times_ms(20), PERIOD_MS) for _ in range(20)]
    mean = [np.mean([one.ejection_ml_per_s for one in some if one]) for some in (rates, few)]
    assert mean[0] < mean[1]
