"""Laws of the split into thirds."""

import numpy as np
import pytest
import trimesh
from hypothesis import given
from hypothesis import strategies as st

from worker.evaluation.size import volume_ml
from worker.evaluation.thirds import Thirds, mean_excess, thirds
from worker.surface_mesh import SurfaceMesh

UP = np.array([0.0, 0.0, 1.0])
OBLIQUE = np.array([2.0, -1.0, 2.0]) / 3.0


def mesh_of(shape: trimesh.Trimesh) -> SurfaceMesh:
    return SurfaceMesh(np.asarray(shape.vertices, float), np.asarray(shape.faces, np.int64))


@pytest.fixture(scope="module")
def ball() -> SurfaceMesh:
    return mesh_of(trimesh.creation.icosphere(subdivisions=5, radius=30.0))


def test_a_box_is_split_into_exact_thirds() -> None:
    box = mesh_of(trimesh.creation.box((20.0, 30.0, 60.0)))
    np.testing.assert_allclose(thirds(box, UP).volumes_ml(box), [12.0, 12.0, 12.0], rtol=1e-12)


def test_a_ball_has_caps_of_the_closed_form(ball: SurfaceMesh) -> None:
    radius, height = 30.0, 20.0
    cap_ml = np.pi * height**2 * (3.0 * radius - height) / 3.0 / 1000.0
    whole_ml = 4.0 / 3.0 * np.pi * radius**3 / 1000.0
    volumes = thirds(ball, UP).volumes_ml(ball)
    np.testing.assert_allclose(volumes, [cap_ml, whole_ml - 2.0 * cap_ml, cap_ml], rtol=2e-3)


def test_parts_sum_to_the_whole_wherever_the_mesh_is(ball: SurfaceMesh) -> None:
    parts = Thirds(OBLIQUE, np.array([-7.0, 40.0]))
    moved = SurfaceMesh(ball.vertices_mm + np.array([100.0, -300.0, 50.0]), ball.faces)
    for mesh in (ball, moved):
        assert parts.volumes_ml(mesh).sum() == pytest.approx(volume_ml(mesh), rel=1e-9)
        assert (parts.volumes_ml(mesh) >= -1e-9).all()


def test_points_belong_to_apex_mid_and_base_in_this_order(ball: SurfaceMesh) -> None:
    parts = thirds(ball, OBLIQUE)
    points = np.outer([-100.0, -29.0, 0.0, 29.0, 100.0], OBLIQUE)
    assert parts.of(points).tolist() == [0, 0, 1, 2, 2]


@given(st.lists(st.floats(-5.0, 5.0), min_size=3, max_size=3))
def test_mean_excess_of_a_height_and_of_its_opposite_differ_by_the_mean(
    corners: list[float],
) -> None:
    heights = np.array([corners])
    above, below = mean_excess(heights)[0], mean_excess(-heights)[0]
    assert above - below == pytest.approx(np.mean(corners), abs=1e-9)
    assert above >= 0.0


def test_mean_excess_is_the_mean_over_the_triangle() -> None:
    generator = np.random.default_rng(0)
    weights = generator.dirichlet(np.ones(3), size=200_000)
    for corners in ([-1.0, 2.0, 0.5], [-3.0, -0.2, 1.0], [0.0, 0.0, 1.0], [-1.0, 0.0, 0.0]):
        sampled = np.maximum(weights @ corners, 0.0).mean()
        assert mean_excess(np.array([corners]))[0] == pytest.approx(sampled, abs=5e-3)
