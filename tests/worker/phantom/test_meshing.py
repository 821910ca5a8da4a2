import numpy as np
import pytest

from worker.evaluation.quality import triangle_quality
from worker.evaluation.size import volume_ml
from worker.evaluation.topology import euler_number, is_outward
from worker.phantom.meshing import mesh_of_implicit


def test_a_sphere_lies_exactly_on_its_formula():
    mesh = mesh_of_implicit(
        lambda points: np.linalg.norm(points, axis=1) - 10.0,
        np.full(3, -10.0),
        np.full(3, 10.0),
        1.0,
    )
    assert is_outward(mesh)
    assert euler_number(mesh) == 2
    np.testing.assert_allclose(np.linalg.norm(mesh.vertices_mm, axis=1), 10.0, atol=1e-9)
    assert volume_ml(mesh) == pytest.approx(4 / 3 * np.pi, rel=5e-3)
    assert triangle_quality(mesh).min_angle_deg > 1.0


def test_the_rim_of_a_flat_top_stays_sharp():
    def cylinder(points: np.ndarray) -> np.ndarray:
        side = np.linalg.norm(points[:, :2], axis=1) - 10.0
        return np.maximum(np.maximum(side, points[:, 2] - 7.3), -5.0 - points[:, 2])

    mesh = mesh_of_implicit(
        cylinder, np.array([-10.0, -10.0, -5.0]), np.array([10.0, 10.0, 7.3]), 1.0
    )
    assert is_outward(mesh)
    top = mesh.vertices_mm[:, 2] > 7.3 - 0.11
    radius = np.linalg.norm(mesh.vertices_mm[top, :2], axis=1)
    assert mesh.vertices_mm[:, 2].max() == pytest.approx(7.3, abs=1e-6)
    assert radius.max() == pytest.approx(10.0, abs=1e-6)
