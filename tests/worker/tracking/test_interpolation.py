"""Faults go where their surroundings went."""

import numpy as np
import trimesh

from tests.worker.tracking.faulty import ball, with_a_fold
from worker.surface_mesh import SurfaceMesh
from worker.tracking.faults import at_fault
from worker.tracking.interpolation import interpolated
from worker.tracking.patch import Patch


def test_a_mesh_without_a_fault_stays_as_it_is() -> None:
    mesh = ball()
    copy_mm = 0.9 * mesh.vertices_mm
    assert interpolated(mesh, copy_mm, Patch.whole(mesh)) is mesh


def test_where_all_around_moved_alike_so_do_the_faults() -> None:
    copy, whole = ball(), Patch.whole(ball())
    moved = SurfaceMesh(copy.vertices_mm + np.array([1.0, -2.0, 3.0]), copy.faces)
    folded = with_a_fold(moved)
    assert at_fault(folded, whole.pairs).any()
    found = interpolated(folded, copy.vertices_mm, whole)
    np.testing.assert_allclose(found.vertices_mm, moved.vertices_mm, atol=1e-9)


def test_displacement_within_is_the_mean_of_that_around() -> None:
    copy, whole = ball(), Patch.whole(ball())
    rng = np.random.default_rng(0)
    moved = copy.vertices_mm * [1.1, 0.9, 1.05] + rng.normal(0.0, 0.05, copy.vertices_mm.shape)
    folded = with_a_fold(SurfaceMesh(moved, copy.faces))
    found = interpolated(folded, copy.vertices_mm, whole)
    assert not at_fault(found, whole.pairs).any()
    inside = (found.vertices_mm != folded.vertices_mm).any(axis=1)
    assert 0 < inside.sum() < len(inside) / 10, "the rest stays where it was"
    displaced = found.vertices_mm - copy.vertices_mm
    means = (whole.neighbours @ displaced) / whole.degrees[:, None]
    np.testing.assert_allclose(displaced[inside], means[inside], atol=1e-9)


def test_a_fault_of_the_copy_stays_alone() -> None:
    """The one beside it is mended all the same."""
    copy, whole = with_a_fold(ball(), 100), Patch.whole(ball())
    twice = with_a_fold(copy, 900)
    here, there = at_fault(copy, whole.pairs).sum(), at_fault(twice, whole.pairs).sum()
    assert 0 < here < there
    found = interpolated(twice, copy.vertices_mm, whole)
    assert at_fault(found, whole.pairs).sum() == here


def test_a_part_that_faults_cover_goes_where_its_copy_is() -> None:
    """An icosahedron has nothing around that would say where it went."""
    mesh, small = ball(), trimesh.creation.icosahedron()
    beside = SurfaceMesh(
        np.concatenate([mesh.vertices_mm, small.vertices + np.array([0.0, 0.0, 30.0])]),
        np.concatenate([mesh.faces, small.faces + len(mesh.vertices_mm)]),
    )
    whole = Patch.whole(beside)
    through = beside.vertices_mm.copy()
    through[-12:, 2] -= 10.0
    crossing = SurfaceMesh(through, beside.faces)
    assert at_fault(crossing, whole.pairs).any()
    found = interpolated(crossing, beside.vertices_mm, whole)
    np.testing.assert_allclose(found.vertices_mm, beside.vertices_mm, atol=1e-6)
