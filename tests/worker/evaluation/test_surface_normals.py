"""Normals of surfaces whose normals have a formula."""

import numpy as np
from hypothesis import given, settings
from hypothesis import strategies as st

from worker.evaluation.surface_normals import normals_at, unit, vertex_normals
from worker.surface_mesh import SurfaceMesh


def test_on_a_sphere_they_are_the_radii(sphere) -> None:
    np.testing.assert_allclose(vertex_normals(sphere), sphere.vertices_mm / 20.0, atol=0.01)
    points = np.array([[30.0, 0.0, 0.0], [0.0, -3.0, 4.0]])
    np.testing.assert_allclose(
        normals_at(points, sphere), [[1.0, 0.0, 0.0], [0.0, -0.6, 0.8]], atol=0.02
    )


def test_on_a_torus_they_point_away_from_its_core(torus) -> None:
    flat = torus.vertices_mm * [1.0, 1.0, 0.0]
    core = 20.0 * unit(flat)
    cosines = np.einsum("nd,nd->n", vertex_normals(torus), unit(torus.vertices_mm - core))
    assert cosines.min() > 0.99


def test_turned_inside_out_they_point_inward(sphere) -> None:
    inward = SurfaceMesh(sphere.vertices_mm, sphere.faces[:, ::-1])
    np.testing.assert_allclose(vertex_normals(inward), -vertex_normals(sphere), atol=1e-12)


def test_a_vertex_in_no_triangle_with_area_has_none() -> None:
    flat = SurfaceMesh(np.array([[0.0, 0, 0], [1, 0, 0], [2, 0, 0]]), np.array([[0, 1, 2]]))
    np.testing.assert_array_equal(vertex_normals(flat), np.zeros((3, 3)))


@settings(deadline=None)
@given(
    st.lists(st.floats(-1e3, 1e3).filter(lambda x: not 0 < abs(x) < 1e-9), min_size=3, max_size=3)
)
def test_a_unit_vector_has_length_one_or_none(vector: list[float]) -> None:
    (found,) = unit(np.array([vector]))
    if np.linalg.norm(vector) > 0.0:
        np.testing.assert_allclose(np.linalg.norm(found), 1.0, rtol=1e-6)
    else:
        assert not found.any()
