"""Faults go where their surroundings went."""

import numpy as np

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


def test_a_mesh_that_was_at_fault_at_rest_is_given_back() -> None:
    mesh = with_a_fold(ball())
    whole = Patch.whole(mesh)
    assert interpolated(mesh, mesh.vertices_mm, whole) is mesh
