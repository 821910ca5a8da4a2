import gc

import numpy as np
import pytest

from schemas.problem import InternalError
from worker.evaluation import distance
from worker.evaluation.distance import (
    distances_both_ways,
    points_to_surface_mm,
    summarised_both_ways,
    surface_to_surface,
    vertices_to_surface_mm,
)
from worker.evaluation.kept_by_mesh import KeptByMesh
from worker.surface_mesh import SurfaceMesh


def test_points_have_their_closed_form_distance_to_a_cube(cube):
    points = np.array([[0.0, 0, 0], [7, 0, 0], [8, 9, 0], [8, 9, 17], [5, 1, 2], [4, 4, 4]])
    expected = [5.0, 2.0, 5.0, 13.0, 0.0, 1.0]
    np.testing.assert_allclose(points_to_surface_mm(points, cube), expected, atol=1e-12)


def test_the_distance_is_to_triangles_and_not_to_vertices():
    wide = SurfaceMesh(
        np.array([[-100.0, -100, 0], [100, -100, 0], [0, 200, 0]]), np.array([[0, 1, 2]])
    )
    np.testing.assert_allclose(points_to_surface_mm(np.array([[0.0, 0.0, 3.0]]), wide), [3.0])


def test_any_array_layout_will_do(cube):
    points = np.asfortranarray(np.array([[7.0, 0, 0], [0, 8, 0]]))
    int32 = SurfaceMesh(np.asfortranarray(cube.vertices_mm), cube.faces.astype(np.int32)[::-1])
    np.testing.assert_allclose(points_to_surface_mm(points, int32), [2.0, 3.0])


def test_no_points_have_no_distances(cube):
    assert points_to_surface_mm(np.zeros((0, 3)), cube).shape == (0,)


def test_a_mesh_without_faces_is_refused():
    nothing = SurfaceMesh(np.zeros((0, 3)), np.zeros((0, 3), dtype=np.int64))
    with pytest.raises(InternalError, match="no triangles"):
        points_to_surface_mm(np.zeros((1, 3)), nothing)


def test_a_surface_is_at_no_distance_from_itself(torus):
    distance = surface_to_surface(torus, torus, samples=2000)
    assert distance.mean_mm < 1e-12
    assert distance.hausdorff_mm < 1e-10


def test_concentric_spheres_are_apart_by_the_difference_of_radii(spheres):
    distance = surface_to_surface(spheres(22.0, 6), spheres(20.0, 6), samples=5000)
    for found in (
        distance.mean_mm,
        distance.rms_mm,
        distance.hausdorff95_mm,
        distance.hausdorff_mm,
    ):
        assert found == pytest.approx(2.0, abs=0.01)


def test_a_shifted_sphere_has_its_closed_form_distances(spheres):
    # |R n + s| - R over the sphere: mean |s.n| = s/2, max s, RMS s/sqrt(3), to first order in s/R.
    sphere, shift = spheres(100.0, 6), 1.0
    moved = SurfaceMesh(sphere.vertices_mm + np.array([0.0, 0.0, shift]), sphere.faces)
    distance = surface_to_surface(moved, sphere, samples=40_000)
    assert distance.mean_mm == pytest.approx(shift / 2, abs=0.02)
    assert distance.rms_mm == pytest.approx(shift / np.sqrt(3), abs=0.02)
    assert distance.hausdorff_mm == pytest.approx(shift, abs=0.04)
    assert distance.hausdorff95_mm == pytest.approx(0.95 * shift, abs=0.03)


def test_directions_are_told_apart(cube, sphere):
    # The cube is within the sphere: from the sphere the cube's corners are near, its sides far.
    distance = surface_to_surface(cube, sphere, samples=2000)
    assert distance.to_reference.max_mm == pytest.approx(15.0, abs=0.3)
    assert distance.to_reference.mean_mm != pytest.approx(distance.from_reference.mean_mm, abs=0.1)
    back = surface_to_surface(sphere, cube, samples=2000)
    assert back.to_reference.mean_mm == pytest.approx(distance.from_reference.mean_mm, abs=0.2)
    assert back.hausdorff_mm == pytest.approx(distance.hausdorff_mm, abs=0.2)


def test_the_seed_decides(cube, sphere):
    assert surface_to_surface(cube, sphere, 500, 3) == surface_to_surface(cube, sphere, 500, 3)
    assert surface_to_surface(cube, sphere, 500, 3) != surface_to_surface(cube, sphere, 500, 4)


def test_what_is_summarised_can_be_had_point_by_point(cube, sphere):
    there, back = distances_both_ways(cube, sphere, 500, 3)
    assert summarised_both_ways(there, back) == surface_to_surface(cube, sphere, 500, 3)
    assert np.abs(there.points_mm).max(axis=1) == pytest.approx(5.0)
    np.testing.assert_allclose(back.distances_mm, points_to_surface_mm(back.points_mm, cube))


def test_a_mesh_is_prepared_once_and_forgotten_with_it(spheres, monkeypatch):
    mesh, trees = spheres(20.0), KeptByMesh()
    monkeypatch.setattr(distance, "_TREES", trees)
    far, near = np.array([[0.0, 0.0, 30.0]]), np.array([[0.0, 0.0, 25.0], [0.0, 0.0, 19.0]])
    np.testing.assert_allclose(points_to_surface_mm(far, mesh), [10.0], atol=0.01)
    np.testing.assert_allclose(points_to_surface_mm(near, mesh), [5.0, 1.0], atol=0.01)
    assert len(trees) == 1
    del mesh
    gc.collect()
    assert len(trees) == 0


def test_vertices_are_measured_once_for_as_long_as_both_meshes_are_in_use(spheres, monkeypatch):
    inner, outer, between = spheres(20.0), spheres(22.0), KeptByMesh()
    monkeypatch.setattr(distance, "_BETWEEN", between)
    found = vertices_to_surface_mm(inner, outer)
    np.testing.assert_array_equal(found, points_to_surface_mm(inner.vertices_mm, outer))
    assert vertices_to_surface_mm(inner, outer) is found
    assert vertices_to_surface_mm(outer, inner) is not found
    assert len(between) == 2
    del inner
    gc.collect()
    assert len(between) == 1
