import numpy as np
import pytest

from worker.evaluation.quality import triangle_quality
from worker.surface_mesh import SurfaceMesh


def triangle(*corners) -> SurfaceMesh:
    return SurfaceMesh(np.array(corners, dtype=float), np.array([[0, 1, 2]]))


def test_an_equilateral_triangle_is_best():
    quality = triangle_quality(triangle([0, 0, 0], [2, 0, 0], [1, np.sqrt(3), 0]))
    assert quality.min_angle_deg == pytest.approx(60.0)
    assert quality.aspect_ratio_max == pytest.approx(1.0)
    assert quality.edge_mean_mm == pytest.approx(2.0)
    assert quality.below_20_deg_percent == 0.0


def test_a_right_triangle_in_closed_form():
    # 3-4-5: circumradius 2.5, inradius 1.
    quality = triangle_quality(triangle([0, 0, 0], [3, 0, 0], [0, 4, 0]))
    assert quality.min_angle_deg == pytest.approx(np.degrees(np.arctan2(3, 4)))
    assert quality.aspect_ratio_mean == pytest.approx(1.25)


def test_a_needle_is_counted():
    quality = triangle_quality(triangle([0, 0, 0], [10, 0, 0], [10, 1, 0]))
    assert quality.below_20_deg_percent == 100.0


@pytest.mark.parametrize("third", [[2, 0, 0], [0, 0, 0]])
def test_a_triangle_without_area_is_worst(third):
    quality = triangle_quality(triangle([0, 0, 0], [1, 0, 0], third))
    assert quality.min_angle_deg == 0.0
    assert quality.aspect_ratio_max == np.inf
