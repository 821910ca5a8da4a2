"""Faults are smoothed away, and what was moved comes back to the surface."""

import numpy as np
import pytest

from tests.worker.tracking.faulty import RADIUS_MM, ball, with_a_fold
from worker.evaluation.distance import points_to_surface_mm
from worker.surface_mesh import SurfaceMesh
from worker.tracking.faults import broken
from worker.tracking.frame_surface import FrameSurface
from worker.tracking.patch import Patch
from worker.tracking.untangling import untangled


def test_a_sound_mesh_stays_as_it_is() -> None:
    mesh = ball()
    found = untangled(mesh, FrameSurface(mesh), Patch.whole(mesh))
    np.testing.assert_array_equal(found.vertices_mm, mesh.vertices_mm)


def test_a_fold_is_undone_and_its_vertices_are_on_the_surface_again() -> None:
    mesh, whole = ball(), Patch.whole(ball())
    folded = with_a_fold(mesh)
    assert broken(folded, whole.pairs).any()
    found = untangled(folded, FrameSurface(mesh), whole)
    assert not broken(found, whole.pairs).any()
    off_mm = np.abs(np.linalg.norm(found.vertices_mm, axis=1) - RADIUS_MM)
    assert off_mm.max() < 0.05
    moved = (found.vertices_mm != mesh.vertices_mm).any(axis=1)
    assert 0 < moved.sum() < len(moved) / 4, "the rest stays where it was"


def crumpled_lens(thickness_mm: float, noise_mm: float) -> tuple[SurfaceMesh, SurfaceMesh]:
    """Two sheets thinner than their triangles, as they are and with every vertex put wrong."""
    mesh = ball()
    flat = mesh.vertices_mm * [1.0, 1.0, thickness_mm / (2.0 * RADIUS_MM)]
    noise = np.random.default_rng(1).normal(0.0, noise_mm, flat.shape)
    return SurfaceMesh(flat, mesh.faces), SurfaceMesh(flat + noise, mesh.faces)


@pytest.mark.parametrize("noise_mm", [0.2, 0.5, 1.0])
def test_two_sheets_that_went_through_each_other_come_apart(noise_mm: float) -> None:
    lens, crumpled = crumpled_lens(1.0, noise_mm)
    whole = Patch.whole(lens)
    assert broken(crumpled, whole.pairs).sum() > 500
    found = untangled(crumpled, FrameSurface(lens), whole)
    assert not broken(found, whole.pairs).any()
    before_mm = points_to_surface_mm(crumpled.vertices_mm, lens).mean()
    assert points_to_surface_mm(found.vertices_mm, lens).mean() < 0.55 * before_mm
