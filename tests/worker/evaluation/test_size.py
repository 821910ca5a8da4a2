import numpy as np
import pytest

from schemas.problem import InternalError
from worker.evaluation.size import area_cm2, signed_volume_ml, triangle_areas_mm2, volume_ml
from worker.surface_mesh import SurfaceMesh


def test_a_cube_is_measured_exactly(cube):
    assert volume_ml(cube) == pytest.approx(1.0, rel=1e-12)
    assert area_cm2(cube) == pytest.approx(6.0, rel=1e-12)
    assert triangle_areas_mm2(cube) == pytest.approx(np.full(12, 50.0))


def test_spheres_converge_quadratically_to_the_closed_form(spheres):
    exact_ml = 4.0 / 3.0 * np.pi * 20.0**3 / 1000.0
    errors = [exact_ml - volume_ml(spheres(20.0, level)) for level in (3, 4, 5)]
    assert errors[0] / errors[1] == pytest.approx(4.0, rel=0.05)
    assert errors[1] / errors[2] == pytest.approx(4.0, rel=0.05)
    assert errors[2] / exact_ml < 2e-3


def test_an_ellipsoid_has_its_closed_form_volume(spheres):
    unit = spheres(1.0, 6)
    ellipsoid = SurfaceMesh(unit.vertices_mm * np.array([20.0, 25.0, 60.0]), unit.faces)
    assert volume_ml(ellipsoid) == pytest.approx(4 / 3 * np.pi * 20 * 25 * 60 / 1000, rel=1e-3)


def test_a_sphere_has_its_closed_form_area(sphere):
    assert area_cm2(sphere) == pytest.approx(4.0 * np.pi * 4.0, rel=2e-3)


def test_volume_does_not_depend_on_where_the_mesh_lies(sphere):
    far = SurfaceMesh(sphere.vertices_mm + np.array([1e6, -2e6, 3e6]), sphere.faces)
    assert volume_ml(far) == pytest.approx(volume_ml(sphere), rel=1e-6)


def test_facing_inward_makes_the_volume_negative(cube):
    inward = SurfaceMesh(cube.vertices_mm, cube.faces[:, ::-1])
    assert signed_volume_ml(inward) == pytest.approx(-1.0)
    with pytest.raises(InternalError, match="reverse the order of its faces"):
        volume_ml(inward)
