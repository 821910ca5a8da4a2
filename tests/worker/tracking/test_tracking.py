"""One mesh through a cycle whose every point's way is known."""

import numpy as np
import pytest

from schemas.job import Progress
from tests.worker.tracking.ellipsoids import Beat, own_surface, phases, sphere
from worker.evaluation.size import signed_volume_ml
from worker.evaluation.surface_normals import vertex_normals
from worker.observer import Cancelled
from worker.surface_mesh import SurfaceMesh
from worker.tracking.area_strain import area_strain
from worker.tracking.tracked_surface import TrackedSurface
from worker.tracking.tracking import track


def tracked(beat: Beat, count: int, *, outer: bool) -> tuple[TrackedSurface, np.ndarray]:
    """The tracked surface, and where its vertices truly are: (count, n, 3)."""
    vertices, faces = sphere()
    truth = np.stack([beat.at(vertices, phase, outer=outer) for phase in phases(count)])
    surfaces = [
        (f"F{index:02d}", own_surface(beat, phase, outer=outer))
        for index, phase in enumerate(phases(count))
    ]
    return track(SurfaceMesh(truth[0], faces), surfaces, 0), truth


def errors_mm(found: TrackedSurface, truth: np.ndarray) -> tuple[np.ndarray, np.ndarray]:
    """Mean error along the true normal and across it, by frame."""
    along, across = [], []
    for frame, positions in enumerate(truth):
        normals = vertex_normals(SurfaceMesh(positions, found.faces))
        error = found.vertices_mm[frame] - positions
        normal = np.einsum("nd,nd->n", error, normals)
        along.append(np.abs(normal).mean())
        across.append(np.linalg.norm(error - normal[:, None] * normals, axis=1).mean())
    return np.array(along), np.array(across)


def sound(found: TrackedSurface) -> None:
    for frame in found.frames:
        faults = (frame.turned_over, frame.against_surface, frame.folded)
        assert faults == (0, 0, 0), frame
        assert frame.self_intersections == 0


@pytest.mark.parametrize("outer", [False, True])
def test_a_beating_ellipsoid_is_followed_and_its_points_found_again(outer: bool) -> None:
    found, truth = tracked(Beat(), 6, outer=outer)
    sound(found)
    for frame in found.frames:
        assert frame.to_surface.mean_mm < 0.1
        assert frame.from_surface.p95_mm < 0.2
        assert frame.least_angle_deg > 25.0
    along, across = errors_mm(found, truth)
    assert along.max() < 0.1
    assert across.max() < 1.5
    assert found.drift_mean_mm < 0.2
    for frame, positions in enumerate(truth):
        true_ml = signed_volume_ml(SurfaceMesh(positions, found.faces))
        assert signed_volume_ml(found.mesh(frame)) == pytest.approx(true_ml, rel=0.005)
    true_strain = area_strain(TrackedSurface(truth, found.faces, 0, found.frames, 0.0, 0.0))
    strain = area_strain(found)
    assert not strain[0].any()
    assert strain[3].mean() == pytest.approx(true_strain[3].mean(), abs=0.01)
    assert np.abs(strain[3] - true_strain[3]).mean() < 0.08


def test_twist_of_a_solid_of_revolution_leaves_no_trace_and_is_said_not_to_be_observed() -> None:
    found, truth = tracked(Beat(twist_deg=15.0), 4, outer=False)
    still, _ = tracked(Beat(), 4, outer=False)
    sound(found)
    along, across = errors_mm(found, truth)
    assert along.max() < 0.1
    assert across[2] > 0.5
    assert np.abs(found.vertices_mm - still.vertices_mm).mean() < 0.3
    assert "twist" in found.not_observed


def test_one_step_of_ten_millimetres_does_not_fold() -> None:
    found, _ = tracked(Beat(thinner=0.4, shorter=0.2, apex_mm=10.0), 2, outer=False)
    sound(found)
    assert found.frames[1].step_max_mm > 10.0
    assert found.frames[1].to_surface.mean_mm < 0.1


def test_a_surface_that_stays_is_tracked_by_the_mesh_itself() -> None:
    vertices, faces = sphere(3)
    mesh = SurfaceMesh(20.0 * vertices, faces)
    found = track(mesh, [("A", mesh), ("B", mesh), ("C", mesh)], 1)
    assert np.abs(found.vertices_mm - mesh.vertices_mm).max() < 1e-6
    assert found.drift_max_mm < 1e-6
    assert (found.vertices_mm[1] == mesh.vertices_mm).all()
    assert np.abs(area_strain(found)).max() < 1e-6


def test_it_moves_and_turns_with_the_heart_and_repeats_itself() -> None:
    vertices, faces = sphere(3)
    mesh = SurfaceMesh(vertices * [20.0, 20.0, 35.0], faces)
    then = SurfaceMesh(vertices * [15.0, 16.0, 30.0], faces)
    turn = np.array([[0.0, -1.0, 0.0], [1.0, 0.0, 0.0], [0.0, 0.0, 1.0]])

    def placed(one: SurfaceMesh) -> SurfaceMesh:
        return SurfaceMesh(one.vertices_mm @ turn.T + [100.0, -50.0, 7.0], one.faces)

    here = track(mesh, [("A", mesh), ("B", then)], 0)
    again = track(mesh, [("A", mesh), ("B", then)], 0)
    there = track(placed(mesh), [("A", placed(mesh)), ("B", placed(then))], 0)
    assert (here.vertices_mm == again.vertices_mm).all()
    assert np.abs(placed(here.mesh(1)).vertices_mm - there.vertices_mm[1]).max() < 0.01


def test_what_is_not_closed_is_refused_and_a_stop_is_heard() -> None:
    vertices, faces = sphere(2)
    mesh = SurfaceMesh(vertices, faces)
    with pytest.raises(ValueError, match="not closed"):
        track(SurfaceMesh(vertices, faces[1:]), [("A", mesh)], 0)

    class Stopping:
        def advanced(self, progress: Progress) -> None: ...
        def is_cancelled(self) -> bool:
            return True

    with pytest.raises(Cancelled):
        track(mesh, [("A", mesh)], 0, Stopping())


def test_half_a_cycle_is_followed_to_both_ends_and_has_no_drift() -> None:
    beat = Beat()
    surfaces = [
        (f"t{i}", own_surface(beat, phase, outer=False)) for i, phase in enumerate(phases(6)[:4])
    ]
    half = track(surfaces[1][1], surfaces, 1, is_whole_cycle=False)
    assert (half.drift_mean_mm, half.drift_max_mm) == (None, None)
    assert [frame.label for frame in half.frames] == ["t0", "t1", "t2", "t3"]
    np.testing.assert_array_equal(half.vertices_mm[1], surfaces[1][1].vertices_mm)
    onward = track(surfaces[1][1], surfaces[1:], 0, is_whole_cycle=False)
    np.testing.assert_array_equal(half.vertices_mm[1:], onward.vertices_mm)
