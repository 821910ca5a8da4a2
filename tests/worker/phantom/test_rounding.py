import numpy as np

from worker.phantom.rounding import rounded_intersection


def test_it_lies_in_both_and_differs_only_at_the_edge():
    generator = np.random.default_rng(0)
    first, second = generator.uniform(-10, 10, 1000), generator.uniform(-10, 10, 1000)
    rounded = rounded_intersection(first, second, 3.0)
    sharp = np.maximum(first, second)
    assert (rounded >= sharp).all()
    far = np.abs(first - second) >= 3.0
    np.testing.assert_array_equal(rounded[far], sharp[far])
    assert (rounded[~far] > sharp[~far]).all()
    assert (rounded - sharp).max() <= 3.0 / 4.0
