"""Spheres of several radii spread as their radii do."""

import numpy as np
import pytest
import trimesh
from hypothesis import given, settings
from hypothesis import strategies as st

from schemas.problem import InternalError
from tests.worker.evaluation.conftest import as_mesh
from worker.evaluation.spread import vertex_deviation_mm
from worker.surface_mesh import SurfaceMesh


def ball(radius_mm: float, subdivisions: int = 4) -> SurfaceMesh:
    return as_mesh(trimesh.creation.icosphere(subdivisions=subdivisions, radius=radius_mm))


BALL = ball(20.0)


@settings(deadline=None, max_examples=20)
@given(st.lists(st.floats(15.0, 25.0), min_size=1, max_size=4))
def test_spheres_about_one_centre_spread_as_their_radii(radii_mm: list[float]) -> None:
    found = vertex_deviation_mm(BALL, [ball(radius) for radius in radii_mm])
    np.testing.assert_allclose(found, np.std([20.0, *radii_mm], ddof=1), atol=0.04)


def test_one_other_surface(spheres) -> None:
    found = vertex_deviation_mm(BALL, [ball(22.0)])
    np.testing.assert_allclose(found, 2.0 / np.sqrt(2.0), atol=0.03)


def test_copies_have_no_spread(torus) -> None:
    assert vertex_deviation_mm(torus, [torus, torus]).max() < 1e-9


def test_sides_are_told_apart() -> None:
    """One sphere outside and one inside: the mean is near the surface, the spread is not."""
    np.testing.assert_allclose(vertex_deviation_mm(BALL, [ball(21.0), ball(19.0)]), 1.0, atol=0.03)
    same_side = vertex_deviation_mm(BALL, [ball(21.0), ball(21.0)])
    np.testing.assert_allclose(same_side, 1.0 / np.sqrt(3.0), atol=0.03)


def test_a_shift_spreads_by_its_part_along_the_normal() -> None:
    """|R n - s| - R is -s n_z, to first order in s / R."""
    fine = ball(100.0, 5)
    moved = SurfaceMesh(fine.vertices_mm + np.array([0.0, 0.0, 1.0]), fine.faces)
    found = vertex_deviation_mm(fine, [moved])
    expected = np.abs(fine.vertices_mm[:, 2]) / 100.0 / np.sqrt(2.0)
    np.testing.assert_allclose(found, expected, atol=0.03)


def upper(mesh: SurfaceMesh, above_mm: float) -> SurfaceMesh:
    heights = mesh.triangles_mm[:, :, 2].mean(axis=1)
    return SurfaceMesh(mesh.vertices_mm, mesh.faces[heights > above_mm])


def test_open_surfaces_spread_alike_where_both_are() -> None:
    one, other = upper(BALL, -5.0), upper(ball(22.0), -5.0)
    found = vertex_deviation_mm(one, [other])
    both = one.vertices_mm[:, 2] > -3.0
    np.testing.assert_allclose(found[both], 2.0 / np.sqrt(2.0), atol=0.03)


def test_where_an_open_surface_ends_is_no_spread_of_the_wall() -> None:
    """A tube cut at two heights: beyond the rim the wall of the other lies where it should."""
    tube = as_mesh(trimesh.creation.cylinder(10.0, 60.0, sections=64).subdivide().subdivide())
    radial = np.linalg.norm(tube.vertices_mm[:, :2], axis=1) > 9.0
    wall = SurfaceMesh(tube.vertices_mm, tube.faces[radial[tube.faces].all(axis=1)])
    heights = wall.triangles_mm[:, :, 2].mean(axis=1)
    short = SurfaceMesh(wall.vertices_mm, wall.faces[heights < 10.0])
    used = np.unique(wall.faces)
    beyond = used[wall.vertices_mm[used, 2] > 20.0]
    assert len(beyond)
    assert vertex_deviation_mm(wall, [short])[beyond].max() < 0.1


def test_without_other_surfaces_there_is_no_spread() -> None:
    with pytest.raises(InternalError, match="ensemble"):
        vertex_deviation_mm(BALL, [])
