"""The middle of a surface's area."""

import numpy as np

from worker.evaluation.area_centroid import area_centroid_mm
from worker.surface_mesh import SurfaceMesh


def test_of_a_sphere_it_is_the_centre_wherever_that_is(sphere) -> None:
    away = np.array([100.0, -50.0, 7.0])
    moved = SurfaceMesh(sphere.vertices_mm + away, sphere.faces)
    np.testing.assert_allclose(area_centroid_mm(moved), away, atol=1e-6)


def test_of_half_a_sphere_it_is_half_a_radius_up(spheres) -> None:
    """Archimedes: equal heights of a sphere have equal areas, so its upper half is at half."""
    ball = spheres(20.0, 6)
    upper = ball.triangles_mm[:, :, 2].mean(axis=1) > 0.0
    x, y, z = area_centroid_mm(SurfaceMesh(ball.vertices_mm, ball.faces[upper]))
    np.testing.assert_allclose([x, y, z], [0.0, 0.0, 10.0], atol=0.1)


def test_dense_triangles_weigh_no_more() -> None:
    """A square of four triangles on one side of its middle and two on the other."""
    corners = np.array([[0.0, 0, 0], [2, 0, 0], [2, 2, 0], [0, 2, 0], [1, 0, 0], [1, 2, 0]])
    middle_left = np.array([[0.5, 1.0, 0.0]])
    faces = [[0, 4, 6], [4, 5, 6], [5, 3, 6], [3, 0, 6], [4, 1, 2], [4, 2, 5]]
    mesh = SurfaceMesh(np.concatenate([corners, middle_left]), np.array(faces))
    np.testing.assert_allclose(area_centroid_mm(mesh), [1.0, 1.0, 0.0], atol=1e-12)
