"""The septum of ventricles that are spheres and tubes."""

import numpy as np
import pytest
import trimesh
from hypothesis import given, settings
from hypothesis import strategies as st
from scipy.spatial.transform import Rotation

from schemas.vocabulary import Structure
from tests.worker.evaluation.conftest import as_mesh
from worker.evaluation.aha_segments import LeftVentricle, aha_segments
from worker.evaluation.area_share import vertex_areas_mm2
from worker.evaluation.septum import LeftSeptum, LongAxis, NoSeptum, RightSeptum, septum
from worker.evaluation.surface_normals import vertex_normals
from worker.phantom.analytic_heart import heart
from worker.surface_mesh import SurfaceMesh

UP = np.array([0.0, 0.0, 1.0])
AXIS = LongAxis(np.zeros(3), UP)
ENDO, EPI, RV = Structure.LV_ENDO, Structure.LV_EPI, Structure.RV_ENDO


def ball(radius_mm: float, centre: tuple[float, float, float] = (0.0, 0.0, 0.0)) -> SurfaceMesh:
    solid = trimesh.creation.icosphere(subdivisions=5, radius=radius_mm)
    solid.apply_translation(centre)
    return as_mesh(solid)


LEFT, RIGHT = ball(25.0), ball(15.0, (-40.0, 0.0, 5.0))
SURFACES = {ENDO: LEFT, RV: RIGHT}


def share(mesh: SurfaceMesh, part: np.ndarray) -> float:
    areas = vertex_areas_mm2(mesh)
    return float(areas[part].sum() / areas.sum())


def test_of_a_left_ventricle_it_is_a_third_of_the_turn() -> None:
    found = septum(ENDO, SURFACES, UP)(LEFT.vertices_mm, vertex_normals(LEFT))
    assert share(LEFT, found) == pytest.approx(1.0 / 3.0, abs=0.01)
    x, y, _ = LEFT.vertices_mm.T
    degrees, off_axis = np.abs(np.degrees(np.arctan2(y, x))), np.hypot(x, y) > 1.0
    assert degrees[found & off_axis].min() >= 119.9
    assert degrees[~found & off_axis].max() <= 120.1


@settings(deadline=None)
@given(st.floats(0.0, 360.0), st.floats(-29.0, 29.0), st.floats(1.0, 60.0))
def test_it_is_the_septal_segments_of_the_standard(
    degrees: float, height_mm: float, radius_mm: float
) -> None:
    """Segments 2, 3, 8 and 9; at the apex, segments 13 to 16 are wider and turned."""
    angle = np.radians(degrees)
    point = np.array([[radius_mm * np.cos(angle), radius_mm * np.sin(angle), height_mm]])
    toward_rv = np.array([-1.0, 0.0, 0.0])
    segment = int(aha_segments(point, LeftVentricle(np.zeros(3), UP, toward_rv, -30.0, 30.0))[0])
    if segment > 12 or abs((degrees % 60.0) - 30.0) > 29.999:
        return
    (found,) = LeftSeptum(AXIS, toward_rv)(point, np.zeros((1, 3)))
    assert found == (segment in (2, 3, 8, 9))


def test_a_point_on_the_axis_faces_nobody() -> None:
    points, normals = np.outer([-30.0, 0.0, 30.0], UP), np.outer([-1.0, 0.0, 1.0], UP)
    assert not LeftSeptum(AXIS, np.array([1.0, 0.0, 0.0]))(points, normals).any()
    assert not RightSeptum(AXIS)(points, normals).any()


def test_of_a_far_ball_it_is_a_quarter() -> None:
    """Normals within 60 degrees of one direction: a cap of (1 - cos 60) / 2 of the ball."""
    far = ball(15.0, (-5000.0, 0.0, 0.0))
    found = RightSeptum(AXIS)(far.vertices_mm, vertex_normals(far))
    assert share(far, found) == pytest.approx(0.25, abs=0.01)
    assert far.vertices_mm[found, 0].min() >= -5000.0 + 7.5 - 0.5


def test_of_a_tube_about_the_left_ventricle_it_is_the_inner_wall() -> None:
    tube = as_mesh(trimesh.creation.annulus(r_min=30.0, r_max=40.0, height=60.0, sections=64))
    middles = tube.triangles_mm.mean(axis=1)
    corners = tube.triangles_mm
    across = np.cross(corners[:, 1] - corners[:, 0], corners[:, 2] - corners[:, 0])
    normals = across / np.linalg.norm(across, axis=1, keepdims=True)
    found = RightSeptum(AXIS)(middles, normals)
    inner = np.linalg.norm(middles[:, :2], axis=1) < 31.0
    np.testing.assert_array_equal(found, inner & (np.abs(middles[:, 2]) < 29.9))


def test_it_moves_with_the_heart() -> None:
    turn = Rotation.from_euler("xyz", [0.4, -1.1, 2.0]).as_matrix()
    shift = np.array([90.0, -40.0, 7.0])
    moved = {s: SurfaceMesh(m.vertices_mm @ turn.T + shift, m.faces) for s, m in SURFACES.items()}
    for structure, mesh in SURFACES.items():
        here = septum(structure, SURFACES, UP)(mesh.vertices_mm, vertex_normals(mesh))
        there = septum(structure, moved, turn @ UP)(
            moved[structure].vertices_mm, vertex_normals(moved[structure])
        )
        assert np.mean(here != there) < 0.005


def test_of_a_heart_both_septa_face_each_other() -> None:
    """What of either endocardium is septum lies near the other one, and what is not does not."""
    surfaces = heart(0.0).meshes(2.0)
    left, right = surfaces[ENDO], surfaces[RV]
    # The phantom's own long axis: the direction in which its left ventricle is longest.
    around = left.vertices_mm - left.vertices_mm.mean(axis=0)
    axis = np.linalg.svd(around, full_matrices=False)[2][0]
    for structure, mesh, other in ((ENDO, left, right), (RV, right, left)):
        found = septum(structure, surfaces, axis)(mesh.vertices_mm, vertex_normals(mesh))
        assert 0.15 < share(mesh, found) < 0.45
        apart = trimesh.proximity.ProximityQuery(
            trimesh.Trimesh(other.vertices_mm, other.faces, process=False)
        ).vertex(mesh.vertices_mm)[0]
        assert apart[found].mean() < 0.6 * apart[~found].mean()


@pytest.mark.parametrize(
    ("structure", "surfaces", "toward_base", "reason"),
    [
        (Structure.EPI, SURFACES | {Structure.EPI: ball(70.0)}, UP, "around both ventricles"),
        (ENDO, SURFACES, None, "long axis is not known"),
        (ENDO, {ENDO: LEFT}, UP, "Without rv_endo"),
        (RV, {RV: RIGHT}, UP, "Without lv_endo"),
        (ENDO, {ENDO: LEFT, RV: ball(15.0, (1.0, 0.0, 50.0))}, UP, "not beside the left"),
    ],
)
def test_what_is_missing_is_named(
    structure: Structure,
    surfaces: dict[Structure, SurfaceMesh],
    toward_base: np.ndarray | None,
    reason: str,
) -> None:
    found = septum(structure, surfaces, toward_base)
    assert isinstance(found, NoSeptum)
    assert reason in found.reason


def test_outer_surfaces_stand_in_for_inner_ones() -> None:
    found = septum(EPI, {EPI: LEFT, Structure.RV_EPI: RIGHT}, UP)
    assert isinstance(found, LeftSeptum)
    np.testing.assert_allclose(found.toward_rv, [-1.0, 0.0, 0.0], atol=1e-9)


def test_an_open_base_moves_the_axis_but_little() -> None:
    heights = LEFT.triangles_mm[:, :, 2].mean(axis=1)
    opened = SurfaceMesh(LEFT.vertices_mm + 500.0, LEFT.faces[heights < 15.0])
    aside = SurfaceMesh(RIGHT.vertices_mm + 500.0, RIGHT.faces)
    found = septum(ENDO, {ENDO: opened, RV: aside}, UP)
    np.testing.assert_allclose(found.axis.centre_mm[:2], [500.0, 500.0], atol=0.1)
