import numpy as np
import pytest

from tests.worker.tracking.ellipsoids import Beat, phases, sphere
from worker.artifacts.page.thinned_motion import thinned_motion
from worker.evaluation.distance import points_to_surface_mm
from worker.evaluation.topology import is_watertight
from worker.surface_mesh import SurfaceMesh


@pytest.fixture(scope="module")
def meshes() -> list[SurfaceMesh]:
    vertices, faces = sphere(4)
    beat = Beat(twist_deg=10.0)
    return [SurfaceMesh(beat.at(vertices, p, outer=False), faces) for p in phases(5)]


def test_fewer_triangles_ride_on_those_that_were_there(meshes: list[SurfaceMesh]) -> None:
    moved, faces = thinned_motion(meshes, 1500)
    assert 1300 <= len(faces) <= 1500
    assert moved.shape == (5, faces.max() + 1, 3)
    for positions, mesh in zip(moved, meshes, strict=True):
        assert is_watertight(SurfaceMesh(positions, faces))
        assert points_to_surface_mm(positions, mesh).max() < 1e-6


def test_an_affine_motion_stays_one(meshes: list[SurfaceMesh]) -> None:
    stretch = np.diag([0.8, 0.9, 1.2])
    two = [meshes[0], SurfaceMesh(meshes[0].vertices_mm @ stretch, meshes[0].faces)]
    moved, _ = thinned_motion(two, 1000)
    np.testing.assert_allclose(moved[1], moved[0] @ stretch, atol=1e-9)


def test_a_coarse_mesh_stays_as_it_is(meshes: list[SurfaceMesh]) -> None:
    moved, faces = thinned_motion(meshes, len(meshes[0].faces))
    assert faces is meshes[0].faces
    assert np.array_equal(moved[3], meshes[3].vertices_mm)
