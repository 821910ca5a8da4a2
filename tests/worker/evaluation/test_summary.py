import numpy as np
import pytest

from schemas.problem import InternalError
from worker.evaluation.summary import histogram, summarised


def test_known_distances():
    summary = summarised(np.array([0.0, 3.0, -4.0, 5.0]))
    assert summary.mean == 3.0
    assert summary.rms == pytest.approx(np.sqrt(50.0 / 4.0))
    assert summary.max == 5.0
    assert (summary.p50, summary.p90) == pytest.approx((3.5, 4.7))
    assert summary.p95 == pytest.approx(4.85)
    assert summary.count == 4


def test_nothing_has_no_mean():
    with pytest.raises(InternalError, match="at least one point"):
        summarised(np.zeros(0))


def test_a_distance_is_counted_in_the_bin_that_it_begins():
    found = histogram(np.array([0.0, 0.05, 0.1, -0.3, 4.99, 5.0, 70.0]))
    assert found.bin_width_mm == 0.1
    assert len(found.counts) == 50
    assert {i: n for i, n in enumerate(found.counts) if n} == {0: 2, 1: 1, 3: 1, 49: 1}
    assert found.beyond == 2


def test_nothing_counts_nothing():
    found = histogram(np.zeros(0))
    assert (sum(found.counts), found.beyond) == (0, 0)
