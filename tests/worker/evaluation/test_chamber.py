"""Chambers with a formula: spheres and half-axes."""

import numpy as np
import pytest

from worker.evaluation.chamber import (
    long_axis_length_mm,
    mid_area_cm2,
    mid_perimeter_mm,
    sphericity,
)
from worker.evaluation.size import volume_ml
from worker.surface_mesh import SurfaceMesh

Z = np.array([0.0, 0.0, 1.0])


def stretched(sphere: SurfaceMesh, factor: float) -> SurfaceMesh:
    """A sphere of 20 mm made longer along z, and moved."""
    return SurfaceMesh(
        sphere.vertices_mm * np.array([1.0, 1.0, factor]) + np.array([7.0, -90.0, 300.0]),
        sphere.faces,
    )


@pytest.mark.parametrize("factor", [1.0, 1.5, 2.5])
def test_a_stretched_sphere(sphere, factor: float) -> None:
    chamber = stretched(sphere, factor)
    length_mm = long_axis_length_mm(chamber, Z)
    assert length_mm == pytest.approx(40.0 * factor, rel=1e-3)
    assert sphericity(volume_ml(chamber), length_mm) == pytest.approx(factor**-2, rel=5e-3)
    assert mid_area_cm2(chamber, Z) == pytest.approx(4.0 * np.pi, rel=2e-3)
    assert mid_area_cm2(chamber, -Z) == pytest.approx(4.0 * np.pi, rel=2e-3)
    assert mid_perimeter_mm(chamber, Z) == pytest.approx(40.0 * np.pi, rel=2e-3)
    assert mid_perimeter_mm(chamber, -Z) == pytest.approx(mid_perimeter_mm(chamber, Z))


def test_a_sphere_is_a_sphere_at_every_size(spheres) -> None:
    for radius_mm in (0.5, 5.0, 50.0):
        ball = spheres(radius_mm)
        found = sphericity(volume_ml(ball), long_axis_length_mm(ball, Z))
        assert found == pytest.approx(1.0, rel=2e-3)


def test_a_hole_is_not_area(torus) -> None:
    assert mid_area_cm2(torus, Z) == pytest.approx(np.pi * (6.25 - 2.25), rel=0.02)


def test_the_longest_of_several_outlines_is_taken(torus) -> None:
    assert mid_perimeter_mm(torus, Z) == pytest.approx(2.0 * np.pi * 25.0, rel=0.02)
