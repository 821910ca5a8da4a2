"""Shares of areas above percentiles that can be told beforehand."""

import numpy as np
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st

from worker.evaluation.area_share import area_above_percentile_percent, vertex_areas_mm2
from worker.evaluation.size import area_cm2
from worker.surface_mesh import SurfaceMesh


def test_of_even_points_it_is_what_is_left_of_the_percentile(sphere) -> None:
    """By height of a sphere: the highest tenth of its even vertices has a tenth of its area."""
    areas = vertex_areas_mm2(sphere)
    heights = sphere.vertices_mm[:, 2] + 20.0
    assert area_above_percentile_percent(areas, heights, 90.0) == pytest.approx(10.0, abs=0.3)
    assert area_above_percentile_percent(areas, heights, 75.0) == pytest.approx(25.0, abs=0.3)


def test_points_weigh_as_much_as_their_area() -> None:
    areas = np.array([1.0, 1.0, 1.0, 97.0])
    assert area_above_percentile_percent(areas, np.array([0.0, 1.0, 2.0, 3.0]), 90.0) == 97.0


def test_of_one_amount_none_is_above() -> None:
    assert area_above_percentile_percent(np.ones(10), np.full(10, 2.0), 90.0) == 0.0


def test_points_without_area_do_not_count() -> None:
    areas, amounts = np.array([1.0] * 10 + [0.0] * 90), np.array([0.0] * 9 + [1.0] + [9.0] * 90)
    assert area_above_percentile_percent(areas, amounts, 90.0) == pytest.approx(10.0)


def test_areas_of_vertices_are_that_of_the_mesh(torus) -> None:
    loose = SurfaceMesh(np.concatenate([torus.vertices_mm, np.zeros((1, 3))]), torus.faces)
    areas = vertex_areas_mm2(loose)
    assert areas.sum() == pytest.approx(100.0 * area_cm2(torus))
    assert areas[-1] == 0.0


@settings(deadline=None)
@given(
    st.lists(
        st.tuples(st.floats(0.01, 10.0), st.floats(0.0, 10.0, allow_subnormal=False)),
        min_size=1,
        max_size=50,
    ),
    st.floats(0.0, 100.0),
)
def test_it_is_a_share_and_scales_with_nothing(
    points: list[tuple[float, float]], percent: float
) -> None:
    areas, amounts = np.array(points).T
    share = area_above_percentile_percent(areas, amounts, percent)
    assert 0.0 <= share < 100.0
    # By a power of two, which rounds nothing.
    again = area_above_percentile_percent(4.0 * areas, 0.5 * amounts, percent)
    assert again == pytest.approx(share)
