import numpy as np
import pytest

from schemas.problem import InputError
from schemas.vocabulary import Structure
from worker.evaluation.size import volume_ml
from worker.evaluation.topology import component_count, euler_number, is_outward
from worker.phantom import HeartShape, heart
from worker.phantom.analytic_heart import BACKGROUND, LV_CAVITY, LV_WALL, RV_CAVITY, STRUCTURES

LV = (Structure.LV_ENDO, Structure.LV_EPI)

SHAPES = [
    HeartShape(),
    HeartShape(lv_radius_mm=15.0, lv_apex_depth_mm=40.0, rv_reach_mm=15.0),
    HeartShape(lv_radius_mm=38.0, wall_mm=5.0, rv_reach_mm=45.0, rv_breadth_ratio=1.3),
    HeartShape(rv_breadth_ratio=0.9, rv_reach_mm=12.0, rv_edge_radius_mm=6.0),
    HeartShape(base_height_mm=0.0, rv_depth_ratio=0.6),
]


@pytest.mark.parametrize("shape", SHAPES)
@pytest.mark.parametrize("phase", [0.0, 0.6, 1.0])
def test_surfaces_are_closed_outward_and_spheres_in_kind(shape, phase):
    instant = heart(phase, shape)
    for structure, mesh in instant.meshes(2.0).items():
        assert is_outward(mesh), structure
        assert euler_number(mesh) == 2, structure
        assert component_count(mesh) == 1, structure
        np.testing.assert_allclose(instant.implicit_mm(structure, mesh.vertices_mm), 0.0, atol=1e-3)


def test_meshes_converge_to_the_closed_form_volume():
    instant = heart(0.0)
    for structure in LV:
        exact_ml = instant.closed_form_volume_ml(structure)
        coarse, fine = (volume_ml(instant.meshes(edge)[structure]) for edge in (2.0, 1.0))
        assert fine == pytest.approx(exact_ml, rel=1e-3)
        assert abs(fine - exact_ml) < abs(coarse - exact_ml) / 2.5
    assert instant.closed_form_volume_ml(Structure.RV_ENDO) is None


def test_volumes_are_a_persons():
    rest, squeezed = heart(0.0).meshes(1.5), heart(1.0).meshes(1.5)
    rv_rest, rv_squeezed = (volume_ml(m[Structure.RV_ENDO]) for m in (rest, squeezed))
    assert 100.0 < rv_rest < 180.0
    assert 0.45 < 1.0 - rv_squeezed / rv_rest < 0.60


def test_tissues_are_nested_and_apart():
    instant = heart(0.3)
    corners = np.concatenate([m.vertices_mm for m in instant.meshes(3.0).values()])
    points = np.random.default_rng(0).uniform(
        corners.min(axis=0) - 5.0, corners.max(axis=0) + 5.0, size=(50_000, 3)
    )
    inside = {s: instant.implicit_mm(s, points) < 0.0 for s in STRUCTURES}
    assert not (inside[Structure.LV_ENDO] & ~inside[Structure.LV_EPI]).any()
    assert not (inside[Structure.RV_ENDO] & inside[Structure.LV_EPI]).any()
    tissue = instant.contains(points)
    assert (inside[Structure.LV_ENDO] == (tissue == LV_CAVITY)).all()
    assert (inside[Structure.LV_EPI] == np.isin(tissue, [LV_CAVITY, LV_WALL])).all()
    assert (inside[Structure.RV_ENDO] == (tissue == RV_CAVITY)).all()
    assert (tissue == BACKGROUND).any()


def test_counting_tissue_gives_the_closed_form_volume():
    instant = heart(0.0)
    mesh = instant.meshes(3.0)[Structure.LV_EPI]
    low, high = mesh.vertices_mm.min(axis=0) - 1.0, mesh.vertices_mm.max(axis=0) + 1.0
    points = np.random.default_rng(1).uniform(low, high, size=(200_000, 3))
    share = np.mean(instant.contains(points) == LV_CAVITY)
    expected = instant.closed_form_volume_ml(Structure.LV_ENDO)
    assert share * np.prod(high - low) / 1000.0 == pytest.approx(expected, rel=0.02)


def test_the_implicit_is_a_distance_near_the_surface():
    instant = heart(0.0)
    for structure, mesh in instant.meshes(1.0).items():
        corners = mesh.triangles_mm
        normals = np.cross(corners[:, 1] - corners[:, 0], corners[:, 2] - corners[:, 0])
        normals /= np.linalg.norm(normals, axis=1, keepdims=True)
        middle = corners.mean(axis=1)
        # Away from the base, whose rim has no normal; chords cut the crescent's round edge.
        below = instant.pose.to_heart(middle)[:, 2] < instant.layout.base_mm - 4.0
        outside = instant.implicit_mm(structure, (middle + 0.2 * normals)[below])
        assert np.median(outside) == pytest.approx(0.2, abs=0.03)
        assert np.mean(outside > 0.0) > 0.99, structure


def test_the_heart_has_no_plane_of_symmetry():
    """A reconstruction mirrored in front-to-back direction must not pass for the right one."""
    instant = heart(0.0)
    own = instant.pose.to_heart(instant.meshes(3.0)[Structure.RV_ENDO].vertices_mm)
    mirrored = instant.pose.to_patient(own * np.array([1.0, -1.0, 1.0]))
    assert np.abs(instant.implicit_mm(Structure.RV_ENDO, mirrored)).max() > 3.0


@pytest.mark.parametrize("phase", [-0.1, 1.5, float("nan")])
def test_a_phase_out_of_the_beat_is_refused(phase):
    with pytest.raises(InputError, match=r"phase = .*between 0 and 1"):
        heart(phase)


def test_a_structure_it_lacks_is_refused():
    with pytest.raises(InputError, match="no rv_epi; ask for"):
        heart().implicit_mm(Structure.RV_EPI, np.zeros((1, 3)))


def test_edges_out_of_bounds_are_refused():
    with pytest.raises(InputError, match=r"edge_mm = .*between 0\.2 and 5"):
        heart().meshes(0.01)
