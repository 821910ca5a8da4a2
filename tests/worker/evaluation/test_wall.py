"""Thickness and mass of walls whose formula is known."""

import numpy as np
import pytest

from worker.evaluation.aha_segments import LeftVentricle
from worker.evaluation.size import volume_ml
from worker.evaluation.wall import thickness_by_segment, wall_mass_g, wall_thickness_mm
from worker.surface_mesh import SurfaceMesh

CENTRED = LeftVentricle(
    np.zeros(3), np.array([0.0, 0.0, 1.0]), np.array([-1.0, 0.0, 0.0]), -25.0, 15.0
)


def test_between_concentric_spheres_the_wall_is_their_difference(spheres) -> None:
    thickness_mm = wall_thickness_mm(spheres(25.0), spheres(35.0))
    np.testing.assert_allclose(thickness_mm, 10.0, atol=0.02)


def test_a_shifted_cavity_has_a_thin_and_a_thick_side(spheres) -> None:
    cavity = spheres(20.0)
    shifted = SurfaceMesh(cavity.vertices_mm + np.array([4.0, 0.0, 0.0]), cavity.faces)
    thickness_mm = wall_thickness_mm(shifted, spheres(35.0))
    expected_mm = 35.0 - np.linalg.norm(shifted.vertices_mm, axis=1)
    np.testing.assert_allclose(thickness_mm, expected_mm, atol=0.02)
    assert (thickness_mm.min(), thickness_mm.max()) == pytest.approx((11.0, 19.0), abs=0.03)


def test_every_segment_of_an_even_wall_is_as_thick(spheres) -> None:
    parts = thickness_by_segment(spheres(25.0), spheres(35.0), CENTRED)
    assert sorted(parts) == list(range(1, 18))
    for number in range(1, 17):
        assert parts[number].mean_mm == pytest.approx(10.0, abs=0.02)
    # Below the cavity the outer sphere's cap reaches from the tip to the cavity's own height.
    assert parts[17].min_mm == pytest.approx(10.0, abs=0.02)
    assert 10.0 <= parts[17].mean_mm <= parts[17].max_mm


def test_a_thick_septum_is_found_in_the_septal_segments(spheres) -> None:
    cavity = spheres(20.0)
    shifted = SurfaceMesh(cavity.vertices_mm + np.array([5.0, 0.0, 0.0]), cavity.faces)
    parts = thickness_by_segment(shifted, spheres(35.0), CENTRED)
    septal = [parts[n].mean_mm for n in (2, 3, 8, 9, 14)]
    lateral = [parts[n].mean_mm for n in (5, 6, 11, 12, 16)]
    assert min(septal) > 15.0 > max(lateral)


def test_a_wall_weighs_its_volume_times_its_density(spheres) -> None:
    endo_ml, epi_ml = (volume_ml(spheres(radius_mm)) for radius_mm in (25.0, 35.0))
    expected_g = 1.05 * 4e-3 / 3 * np.pi * (35.0**3 - 25.0**3)
    assert wall_mass_g(endo_ml, epi_ml) == pytest.approx(expected_g, rel=2e-3)
