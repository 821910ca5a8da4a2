import pytest

from worker.evaluation.function import lv_function


def test_textbook_volumes():
    found = lv_function(120.0, 50.0)
    assert found.lv_stroke_volume_ml == 70.0
    assert found.lv_ejection_fraction_percent == pytest.approx(58.333, abs=1e-3)
