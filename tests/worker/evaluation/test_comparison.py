import numpy as np
import pytest

from worker.evaluation.comparison import closed_volume_ml, compared, volume_difference_percent
from worker.surface_mesh import SurfaceMesh


def test_a_scaled_sphere(spheres):
    found = compared(spheres(22.0), spheres(20.0), samples=5000)
    assert found.volume_difference_percent == pytest.approx(100.0 * (1.1**3 - 1.0))
    assert found.surface_distance.mean_mm == pytest.approx(2.0, abs=0.02)
    assert found.point_set_distance.rms_chamfer_mm > found.surface_distance.rms_mm
    assert found.mesh.watertight
    assert found.reference.euler_number == 2


def test_the_point_set_form_has_a_floor_where_the_exact_one_has_none(sphere):
    found = compared(sphere, sphere, samples=5000)
    assert found.surface_distance.hausdorff_mm < 1e-10
    assert found.point_set_distance.hausdorff50_mm > 0.1


def test_an_open_surface_has_no_volume(sphere):
    holed = SurfaceMesh(sphere.vertices_mm, sphere.faces[1:])
    found = compared(holed, sphere, samples=500)
    assert found.mesh.volume_ml is None
    assert found.volume_difference_percent is None
    assert found.reference.volume_ml == pytest.approx(4 / 3 * np.pi * 8.0, rel=2e-3)


def test_curvature_needs_to_be_asked_for_and_both_surfaces_closed(spheres):
    one, other = spheres(22.0, 4), spheres(20.0, 4)
    holed = SurfaceMesh(one.vertices_mm, one.faces[1:])
    assert compared(one, other, samples=500).curvature is None
    assert compared(holed, other, samples=500, curvature_edge_mm=3.0).curvature is None
    found = compared(one, other, samples=500, curvature_edge_mm=3.0).curvature
    assert found.mean_per_mm.mean_abs == pytest.approx(1 / 20.0 - 1 / 22.0, rel=0.15)


def test_volumes_are_told_apart_only_where_both_are_known(sphere):
    assert volume_difference_percent(110.0, 100.0) == pytest.approx(10.0)
    assert volume_difference_percent(None, 100.0) is None
    assert volume_difference_percent(100.0, None) is None
    assert volume_difference_percent(100.0, 0.0) is None
    inward = SurfaceMesh(sphere.vertices_mm, sphere.faces[:, ::-1])
    assert closed_volume_ml(inward) == pytest.approx(closed_volume_ml(sphere))
    assert closed_volume_ml(SurfaceMesh(sphere.vertices_mm, sphere.faces[1:])) is None


def test_both_forms_measure_the_same_points(spheres):
    """So they differ by what nearest points and nearest triangles differ by, and no more."""
    found = compared(spheres(25.0), spheres(20.0), samples=5000)
    exact, points = found.surface_distance.to_reference, found.point_set_distance.to_reference
    assert points.samples == exact.samples
    assert exact.mean_mm < points.mean_mm < exact.mean_mm + 0.1
