"""What is carried has no fault to carry."""

import numpy as np
import pytest

from tests.worker.tracking.faulty import ball, with_a_fin
from worker.evaluation.topology import is_watertight
from worker.observer import Cancelled, Unobserved
from worker.surface_mesh import SurfaceMesh
from worker.tracking.faults import FaceFlags, at_fault, broken
from worker.tracking.patch import Patch
from worker.tracking.sound_mesh import sound_mesh


def faulty(mesh: SurfaceMesh) -> FaceFlags:
    pairs = Patch.whole(mesh).pairs
    return broken(mesh, pairs) | at_fault(mesh, pairs)


def test_a_sound_mesh_stays_as_it_is() -> None:
    mesh = ball()
    found = sound_mesh(mesh)
    assert found.faults == 0
    np.testing.assert_array_equal(found.mesh.vertices_mm, mesh.vertices_mm)
    np.testing.assert_array_equal(found.mesh.faces, mesh.faces)


def test_a_fin_that_smoothing_does_not_lay_flat_is_drawn_together() -> None:
    mesh = with_a_fin(ball())
    assert is_watertight(mesh)
    assert faulty(mesh).any()
    found = sound_mesh(mesh)
    assert is_watertight(found.mesh)
    assert found.faults == 0
    assert not faulty(found.mesh).any()
    assert len(found.mesh.faces) < len(mesh.faces)


def test_it_is_cancelled_before_the_next_round() -> None:
    class AfterOne(Unobserved):
        looks = 0

        def is_cancelled(self) -> bool:
            self.looks += 1
            return self.looks > 1

    stopping = AfterOne()
    with pytest.raises(Cancelled):
        sound_mesh(with_a_fin(ball()), stopping)
    assert stopping.looks == 2


def test_faults_that_are_left_are_counted() -> None:
    """Two balls through each other, one mesh: nothing that is smoothed or drawn together helps."""
    one = ball()
    other = one.vertices_mm + np.array([15.0, 0.0, 0.0])
    mesh = SurfaceMesh(
        np.concatenate([one.vertices_mm, other]),
        np.concatenate([one.faces, one.faces + len(other)]),
    )
    found = sound_mesh(mesh)
    assert found.faults == at_fault(found.mesh, Patch.whole(found.mesh).pairs).sum() > 0
