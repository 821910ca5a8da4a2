import numpy as np
import pytest

from worker.evaluation.jitter import jitter


def test_independent_errors_are_found_again() -> None:
    errors = np.random.default_rng(0).normal(size=20_000) * 0.7
    assert jitter(errors.tolist(), is_whole_cycle=True) == pytest.approx(0.7, rel=0.03)


def test_a_line_has_none_and_a_parabola_its_curvature() -> None:
    at = np.arange(9.0)
    assert jitter((5.0 - 2.0 * at).tolist(), is_whole_cycle=False) == pytest.approx(0.0, abs=1e-12)
    assert jitter((3.0 * at**2).tolist(), is_whole_cycle=False) == pytest.approx(6.0 / 6.0**0.5)


def test_a_whole_cycle_closes() -> None:
    """A line that jumps back has two second differences, +n and -n, at its ends."""
    found = jitter([0.0, 1.0, 2.0, 3.0], is_whole_cycle=True)
    assert found == pytest.approx((2.0 * 4.0**2 / 4.0 / 6.0) ** 0.5)
    series = [1.0, 5.0, 2.0, 4.0, 4.5]
    assert jitter(series[2:] + series[:2], is_whole_cycle=True) == pytest.approx(
        jitter(series, is_whole_cycle=True)
    )


def test_gaps_are_left_out() -> None:
    assert jitter([0.0, 1.0, None, 7.0, 8.0, 9.0], is_whole_cycle=False) == pytest.approx(0.0)
    assert jitter([0.0, 1.0, None, 7.0, 9.0], is_whole_cycle=False) is None
    assert jitter([1.0, 2.0], is_whole_cycle=True) is None
