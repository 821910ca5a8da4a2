"""A motion that is known is found and undone."""

import numpy as np
import pytest
import trimesh
from hypothesis import given, settings
from hypothesis import strategies as st
from scipy.spatial.transform import Rotation

from schemas.vocabulary import Structure
from tests.worker.evaluation.conftest import as_mesh
from worker.evaluation.area_centroid import area_centroid_mm
from worker.evaluation.distance import surface_to_surface
from worker.evaluation.rigid_placement import rigid_placement
from worker.observer import Cancelled, Unobserved
from worker.phantom.analytic_heart import heart
from worker.surface_mesh import SurfaceMesh


def lopsided() -> SurfaceMesh:
    """An ellipsoid of three half-axes with a bump on one side: no turn maps it to itself."""
    ball = trimesh.creation.icosphere(subdivisions=4, radius=1.0)
    ball.vertices *= (
        1.0 + 0.3 * np.exp(-8.0 * ((ball.vertices - [0.6, 0.6, 0.5]) ** 2).sum(1))[:, None]
    )
    ball.vertices *= [20.0, 26.0, 35.0]
    return as_mesh(ball)


LOPSIDED = lopsided()


def turned(mesh: SurfaceMesh, rotvec_deg: list[float], shift_mm: list[float]) -> SurfaceMesh:
    turn = Rotation.from_rotvec(rotvec_deg, degrees=True).as_matrix()
    return SurfaceMesh(mesh.vertices_mm @ turn.T + np.array(shift_mm), mesh.faces)


@pytest.mark.parametrize("away_mm", [0.0, 300.0])
def test_five_degrees_and_three_millimetres_are_undone(away_mm: float) -> None:
    """Wherever the origin is: a turn about it moves a far surface far, its centroid says so."""
    true = SurfaceMesh(LOPSIDED.vertices_mm + away_mm, LOPSIDED.faces)
    mesh = turned(true, [5.0 / 3.0, -10.0 / 3.0, 10.0 / 3.0], [2.0, 1.0, -2.0])
    found = rigid_placement(mesh, true)
    assert np.abs(found.moved(mesh).vertices_mm - true.vertices_mm).max() < 0.01
    assert found.rotation_deg == pytest.approx(5.0, abs=0.01)
    np.testing.assert_allclose(
        found.translation_mm, area_centroid_mm(true) - area_centroid_mm(mesh), atol=0.01
    )


@settings(deadline=None, max_examples=8)
@given(
    st.lists(st.floats(-15.0, 15.0), min_size=3, max_size=3),
    st.lists(st.floats(-80.0, 80.0), min_size=3, max_size=3),
)
def test_any_moderate_turn_and_any_shift_are_undone(
    rotvec_deg: list[float], shift_mm: list[float]
) -> None:
    mesh = turned(LOPSIDED, rotvec_deg, shift_mm)
    found = rigid_placement(mesh, LOPSIDED)
    assert np.abs(found.moved(mesh).vertices_mm - LOPSIDED.vertices_mm).max() < 0.01
    np.testing.assert_allclose(found.rotation @ found.rotation.T, np.eye(3), atol=1e-12)
    assert np.linalg.det(found.rotation) == pytest.approx(1.0)
    back = found.moved_back(found.moved(mesh))
    np.testing.assert_allclose(back.vertices_mm, mesh.vertices_mm, atol=1e-9)


def test_other_triangles_of_one_heart_are_laid_onto_each_other() -> None:
    fine, coarse = (heart(0.0).meshes(edge)[Structure.RV_ENDO] for edge in (1.5, 2.0))
    mesh = turned(fine, [0.0, 12.0, 5.0], [5.0, 0.0, -9.0])
    moved = rigid_placement(mesh, coarse).moved(mesh)
    assert np.abs(moved.vertices_mm - fine.vertices_mm).max() < 0.05


def test_what_lies_right_stays() -> None:
    found = rigid_placement(LOPSIDED, LOPSIDED)
    assert found.rotation_deg < 1e-6
    assert np.abs(found.translation_mm).max() < 1e-6


def test_nothing_is_scaled_or_mirrored() -> None:
    """Twice as large, and seen in a mirror: best laid, and still as far off as that makes it."""
    large = SurfaceMesh(1.2 * LOPSIDED.vertices_mm, LOPSIDED.faces)
    assert surface_to_surface(rigid_placement(large, LOPSIDED).moved(large), LOPSIDED).mean_mm > 4.0
    mirrored = SurfaceMesh(LOPSIDED.vertices_mm * [-1.0, 1.0, 1.0], LOPSIDED.faces[:, ::-1])
    found = rigid_placement(mirrored, LOPSIDED)
    assert np.linalg.det(found.rotation) == pytest.approx(1.0)
    assert surface_to_surface(found.moved(mirrored), LOPSIDED).mean_mm > 0.1


def test_a_ball_is_laid_onto_a_ball_and_hardly_turned(spheres) -> None:
    mesh = turned(spheres(22.0), [0.0, 0.0, 0.0], [7.0, -3.0, 2.0])
    found = rigid_placement(mesh, spheres(20.0, 4))
    np.testing.assert_allclose(found.translation_mm, [-7.0, 3.0, -2.0], atol=0.1)
    assert found.rotation_deg < 5.0


def test_where_one_surface_ends_draws_nothing() -> None:
    """Cut open at two thirds of its height it is laid where it belongs, the reference whole."""
    heights = LOPSIDED.triangles_mm[:, :, 2].mean(axis=1)
    opened = SurfaceMesh(LOPSIDED.vertices_mm, LOPSIDED.faces[heights < 12.0])
    mesh = turned(opened, [3.0, -2.0, 4.0], [2.0, 1.0, -2.0])
    for pair in ((mesh, LOPSIDED), (LOPSIDED, mesh)):
        found = rigid_placement(*pair)
        placed = found.moved(mesh) if pair[0] is mesh else found.moved_back(mesh)
        assert np.abs(placed.vertices_mm - LOPSIDED.vertices_mm).max() < 0.01


def test_it_is_the_same_each_time() -> None:
    mesh = turned(LOPSIDED, [3.0, -2.0, 4.0], [2.0, 1.0, -2.0])
    one, other = (rigid_placement(mesh, LOPSIDED) for _ in range(2))
    np.testing.assert_array_equal(one.rotation, other.rotation)
    np.testing.assert_array_equal(one.offset_mm, other.offset_mm)


def test_triangles_that_only_see_each_others_rims_are_still_brought_together() -> None:
    one = SurfaceMesh(np.array([[0.0, 0, 0], [9, 0, 0], [0, 6, 0]]), np.array([[0, 1, 2]]))
    other = SurfaceMesh(one.vertices_mm + np.array([40.0, 0.0, 0.0]), one.faces)
    found = rigid_placement(one, other)
    np.testing.assert_allclose(found.moved(one).vertices_mm, other.vertices_mm, atol=0.01)


class _Impatient(Unobserved):
    def is_cancelled(self) -> bool:
        return True


def test_it_can_be_stopped() -> None:
    with pytest.raises(Cancelled):
        rigid_placement(LOPSIDED, LOPSIDED, _Impatient())
