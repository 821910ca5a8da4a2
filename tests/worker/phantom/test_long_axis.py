import numpy as np
import pytest

from schemas.vocabulary import Structure
from worker.phantom import heart
from worker.phantom.long_axis import long_axis
from worker.surface_mesh import SurfaceMesh


def degrees_between(a: np.ndarray, b: np.ndarray) -> float:
    return float(np.degrees(np.arccos(a @ b / np.linalg.norm(a) / np.linalg.norm(b))))


def test_it_is_the_phantoms_own_axis(diastole):
    axis = long_axis(diastole)
    rotation = heart().pose.rotation
    assert degrees_between(axis.towards_base, rotation[:, 2]) < 1.0
    assert degrees_between(axis.towards_rv, rotation[:, 0]) < 10.0
    assert abs(axis.towards_rv @ axis.towards_base) < 1e-12


@pytest.mark.parametrize("structure", [Structure.LV_ENDO, Structure.LV_EPI])
@pytest.mark.parametrize("phase", [0.0, 1.0])
def test_one_surface_of_the_lv_is_enough(structure, phase):
    mesh = heart(phase).meshes(3.0)[structure]
    axis = long_axis({structure: mesh})
    assert degrees_between(axis.towards_base, heart().pose.rotation[:, 2]) < 1.0
    assert np.linalg.norm(axis.towards_rv) == pytest.approx(1.0)


def test_it_turns_with_the_heart(diastole):
    turn = np.linalg.qr(np.random.default_rng(0).normal(size=(3, 3)))[0]
    turn *= np.linalg.det(turn)
    turned = {s: SurfaceMesh(m.vertices_mm @ turn.T, m.faces) for s, m in diastole.items()}
    before, after = long_axis(diastole), long_axis(turned)
    np.testing.assert_allclose(after.towards_base, turn @ before.towards_base, atol=1e-6)
    np.testing.assert_allclose(after.centre_mm, turn @ before.centre_mm, atol=1e-6)


def test_a_given_direction_is_kept(diastole):
    axis = long_axis(diastole, np.array([0.0, 0.0, 5.0]))
    np.testing.assert_allclose(axis.towards_base, [0.0, 0.0, 1.0])


def test_a_right_ventricle_about_the_axis_gives_no_direction_but_some(diastole):
    mesh = diastole[Structure.LV_EPI]
    axis = long_axis({Structure.RV_EPI: mesh, Structure.RV_ENDO: mesh})
    assert np.linalg.norm(axis.towards_rv) == pytest.approx(1.0)
    assert abs(axis.towards_rv @ axis.towards_base) < 1e-12
