"""Surfaces whose curvature has a formula, against each other."""

import numpy as np
import pytest

from schemas.problem import InternalError
from worker.evaluation.curvature_comparison import compare_curvature
from worker.surface_mesh import SurfaceMesh


@pytest.fixture(scope="module")
def ball(spheres) -> SurfaceMesh:
    """A sphere of 20 mm, in triangles of 1 mm."""
    return spheres(20.0, 4)


def test_a_surface_bends_like_itself(ball) -> None:
    found = compare_curvature(ball, ball)
    assert found.gaussian_per_mm2.rms == pytest.approx(0.0, abs=1e-9)
    assert found.mean_per_mm.rms == pytest.approx(0.0, abs=1e-9)
    assert found.gauss_bonnet_residual_rad < 1e-9


@pytest.mark.parametrize("radius_mm", [22.0, 25.0])
def test_spheres_deviate_by_the_difference_of_their_curvatures(ball, spheres, radius_mm) -> None:
    found = compare_curvature(spheres(radius_mm, 4), ball)
    assert found.mean_per_mm.mean_abs == pytest.approx(1 / 20.0 - 1 / radius_mm, rel=0.15)
    assert found.mean_per_mm.reference_rms == pytest.approx(1 / 20.0, rel=0.02)
    gaussian = 1 / 400.0 - 1 / radius_mm**2
    assert found.gaussian_per_mm2.mean_abs == pytest.approx(gaussian, rel=0.35)
    assert found.gaussian_per_mm2.reference_rms == pytest.approx(1 / 400.0, rel=0.05)


def test_where_it_lies_does_not_matter_to_how_it_bends(ball) -> None:
    moved = SurfaceMesh(ball.vertices_mm + np.array([1.0, 0.5, 0.0]), ball.faces)
    found = compare_curvature(moved, ball)
    assert found.mean_per_mm.rms < 0.05 * found.mean_per_mm.reference_rms


def test_other_triangles_of_one_surface_are_made_alike(ball, spheres) -> None:
    """Raw, the coarser mesh has four times the angle deficit at a vertex."""
    found = compare_curvature(spheres(20.0, 5), ball)
    assert found.mean_per_mm.rms < 0.1 * found.mean_per_mm.reference_rms


def test_a_dent_is_found_where_it_is(ball) -> None:
    """A dent over a twentieth of the sphere: there, and only there, curvature deviates much."""
    up = ball.vertices_mm[:, 2] / 20.0
    depth = np.clip((up - 0.9) / 0.1, 0.0, 1.0) ** 2 * 3.0
    dented = SurfaceMesh(ball.vertices_mm * (1.0 - depth / 20.0)[:, None], ball.faces)
    found = compare_curvature(dented, ball).mean_per_mm
    assert found.rms > 3.0 * found.p75_abs
    assert found.above_p75_area_percent == pytest.approx(25.0, abs=3.0)


def test_a_deviation_is_told_by_region(ball) -> None:
    """A bump at the top: there the deviation is, and not below; parts make up the whole."""
    up = ball.vertices_mm[:, 2] / 20.0
    height = np.clip((up - 0.7) / 0.3, 0.0, 1.0) ** 2 * 3.0
    bumped = SurfaceMesh(ball.vertices_mm * (1.0 + height / 20.0)[:, None], ball.faces)
    regions = {
        "base": lambda points, normals: points[:, 2] > 0.0,
        "apex": lambda points, normals: normals[:, 2] <= 0.0,
        "mid": lambda points, normals: points[:, 2] > 100.0,
    }
    for found in (
        (both := compare_curvature(bumped, ball, regions=regions)).mean_per_mm,
        both.gaussian_per_mm2,
    ):
        parts = found.mean_abs_by_region
        assert parts.keys() == {"base", "apex"}
        assert parts["base"] > 5.0 * parts["apex"]
        assert np.mean([*parts.values()]) == pytest.approx(found.mean_abs, rel=0.05)
    assert compare_curvature(ball, ball).mean_per_mm.mean_abs_by_region == {}


def test_what_is_thinner_than_any_edge_is_refused(ball) -> None:
    """Two triangles back to back are closed and have no inside."""
    flat = SurfaceMesh(
        np.array([[0.0, 0, 0], [10, 0, 0], [0, 10, 0]]), np.array([[0, 1, 2], [0, 2, 1]])
    )
    for pair in ((flat, ball), (ball, flat)):
        with pytest.raises(InternalError, match="too small or too thin"):
            compare_curvature(*pair)


def test_an_open_surface_is_refused(ball) -> None:
    with pytest.raises(InternalError, match="cannot be remeshed"):
        compare_curvature(SurfaceMesh(ball.vertices_mm, ball.faces[1:]), ball)
