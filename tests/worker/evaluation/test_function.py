import pytest

from worker.evaluation.function import lv_function, shrinkage_percent


def test_textbook_volumes():
    found = lv_function(120.0, 50.0)
    assert found.lv_stroke_volume_ml == 70.0
    assert found.lv_ejection_fraction_percent == pytest.approx(58.333, abs=1e-3)


@pytest.mark.parametrize(("systolic", "percent"), [(120.0, 0.0), (60.0, 50.0), (0.0, 100.0)])
def test_what_is_gone(systolic, percent):
    assert shrinkage_percent(120.0, systolic) == pytest.approx(percent)
