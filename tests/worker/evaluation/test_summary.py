import numpy as np
import pytest

from schemas.problem import InternalError
from worker.evaluation.summary import summarised


def test_known_distances():
    summary = summarised(np.array([0.0, 3.0, -4.0, 5.0]))
    assert summary.mean == 3.0
    assert summary.rms == pytest.approx(np.sqrt(50.0 / 4.0))
    assert summary.max == 5.0
    assert summary.p95 == pytest.approx(4.85)
    assert summary.count == 4


def test_nothing_has_no_mean():
    with pytest.raises(InternalError, match="at least one point"):
        summarised(np.zeros(0))
