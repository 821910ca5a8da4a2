import pytest

from schemas.problem import InputError
from worker.phantom.beating.scaling import of_edv
from worker.phantom.contraction import layout
from worker.phantom.shape import HeartShape


def test_the_cavity_holds_what_was_asked_and_proportions_stay():
    shape = of_edv(HeartShape(), 160.0)
    parts = layout(shape, 0.0)
    assert parts.lv_inner.volume_below_ml(parts.base_mm) == pytest.approx(160.0)
    assert shape.wall_mm / shape.lv_radius_mm == pytest.approx(9.0 / 24.5)
    assert shape.apex_wall_ratio == HeartShape().apex_wall_ratio


def test_a_size_beyond_the_bounds_is_refused():
    with pytest.raises(InputError, match="choose between"):
        of_edv(HeartShape(), 4000.0)
