"""Faults are smoothed away, and what was moved comes back to the surface."""

import numpy as np
import pytest

from tests.worker.tracking.ellipsoids import sphere
from worker.surface_mesh import SurfaceMesh
from worker.tracking.frame_surface import FrameSurface
from worker.tracking.untangling import Untangler

RADIUS_MM = 20.0


@pytest.fixture
def ball() -> SurfaceMesh:
    vertices, faces = sphere()
    return SurfaceMesh(RADIUS_MM * vertices / np.linalg.norm(vertices, axis=1)[:, None], faces)


def with_a_fold(mesh: SurfaceMesh, vertex: int = 100) -> SurfaceMesh:
    """The vertex drawn over the far side of a neighbour's triangles."""
    face = mesh.faces[(mesh.faces == vertex).any(axis=1)][0]
    neighbour = int(face[face != vertex][0])
    vertices = mesh.vertices_mm.copy()
    vertices[vertex] += 2.5 * (vertices[neighbour] - vertices[vertex])
    return SurfaceMesh(vertices, mesh.faces)


def test_a_sound_mesh_stays_as_it_is(ball: SurfaceMesh) -> None:
    found = Untangler(ball).untangled(ball, FrameSurface(ball))
    np.testing.assert_array_equal(found.vertices_mm, ball.vertices_mm)


def test_a_fold_is_undone_and_its_vertices_are_on_the_surface_again(ball: SurfaceMesh) -> None:
    folded, untangler = with_a_fold(ball), Untangler(ball)
    assert untangler.broken(folded).any()
    found = untangler.untangled(folded, FrameSurface(ball))
    assert not untangler.broken(found).any()
    off_mm = np.abs(np.linalg.norm(found.vertices_mm, axis=1) - RADIUS_MM)
    assert off_mm.max() < 0.05
    moved = (found.vertices_mm != ball.vertices_mm).any(axis=1)
    assert 0 < moved.sum() < len(moved) / 4, "the rest stays where it was"
