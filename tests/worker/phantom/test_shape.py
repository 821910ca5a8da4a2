import pytest

from schemas.problem import InputError
from worker.phantom.shape import HeartShape


def test_the_default_is_within_bounds():
    assert HeartShape().wall_mm == 9.0


@pytest.mark.parametrize(
    "wrong", [{"wall_mm": 0.0}, {"lv_radius_mm": 400.0}, {"rv_gap_mm": float("nan")}]
)
def test_what_is_no_heart_is_refused_with_its_bounds(wrong):
    (name,) = wrong
    with pytest.raises(InputError, match=f"{name}.*choose between") as refusal:
        HeartShape(**wrong)
    assert refusal.value.pointer == f"/{name}"


def test_lengths_must_fit_each_other():
    with pytest.raises(InputError, match=r"rv_reach_mm = 40; .*between 12 and 22"):
        HeartShape(lv_radius_mm=13.0, wall_mm=7.0, rv_reach_mm=40.0)
    with pytest.raises(InputError, match=r"base_height_mm = 29; .*between 0 and 24"):
        HeartShape(lv_apex_depth_mm=30.0, base_height_mm=29.0)
