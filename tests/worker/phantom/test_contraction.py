import itertools

import numpy as np
import pytest

from worker.phantom.contraction import Layout, layout
from worker.phantom.shape import HeartShape

SHAPES = [
    HeartShape(),
    HeartShape(lv_radius_mm=35.0, wall_mm=6.0),
    HeartShape(lv_radius_mm=18.0, lv_apex_depth_mm=45.0, wall_mm=15.0, apex_wall_ratio=1.2),
]


def cavity_ml(parts: Layout) -> float:
    return parts.lv_inner.volume_below_ml(parts.base_mm)


def muscle_ml(parts: Layout) -> float:
    return parts.lv_outer.volume_below_ml(parts.base_mm) - cavity_ml(parts)


@pytest.mark.parametrize("shape", SHAPES)
def test_the_wall_keeps_its_volume(shape):
    at_rest = muscle_ml(layout(shape, 0.0))
    for phase in (0.25, 0.5, 1.0):
        assert muscle_ml(layout(shape, phase)) == pytest.approx(at_rest, rel=1e-9)


def test_the_cavity_shrinks_all_the_way_to_a_healthy_ejection_fraction():
    volumes = [cavity_ml(layout(HeartShape(), phase)) for phase in np.linspace(0.0, 1.0, 6)]
    assert all(after < before for before, after in itertools.pairwise(volumes))
    assert 0.55 <= 1.0 - volumes[-1] / volumes[0] <= 0.60
    assert 80.0 < volumes[0] < 160.0


@pytest.mark.parametrize("shape", SHAPES)
def test_the_apex_stays_and_the_base_comes_down(shape):
    def apex_mm(parts: Layout) -> float:
        return parts.lv_outer.centre_mm[2] - parts.lv_outer.semi_axes_mm[2]

    rest, squeezed = layout(shape, 0.0), layout(shape, 1.0)
    assert apex_mm(squeezed) == pytest.approx(apex_mm(rest))
    assert 5.0 < rest.base_mm - squeezed.base_mm < 25.0


def test_the_wall_thickens():
    def wall_mm(parts: Layout) -> float:
        return parts.lv_outer.semi_axes_mm[0] - parts.lv_inner.semi_axes_mm[0]

    assert wall_mm(layout(HeartShape(), 0.0)) == pytest.approx(9.0)
    assert wall_mm(layout(HeartShape(), 1.0)) > 11.0
