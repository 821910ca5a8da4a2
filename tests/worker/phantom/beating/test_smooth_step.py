import numpy as np
import pytest

from worker.phantom.beating.smooth_step import smooth_step


def test_it_is_flat_before_and_after_and_half_in_the_middle():
    value, slope = smooth_step(np.array([-9.0, 2.0, 4.0, 6.0, 99.0]), 2.0, 6.0)
    np.testing.assert_array_equal(value, [0.0, 0.0, 0.5, 1.0, 1.0])
    assert slope[[0, 1, 3, 4]].tolist() == [0.0] * 4
    assert slope[2] == pytest.approx(1.875 / 4.0)


def test_its_slope_is_that_of_its_value():
    at = np.linspace(1.9, 6.1, 101)
    above, below = (smooth_step(at + step, 2.0, 6.0)[0] for step in (1e-6, -1e-6))
    np.testing.assert_allclose(smooth_step(at, 2.0, 6.0)[1], (above - below) / 2e-6, atol=1e-8)
