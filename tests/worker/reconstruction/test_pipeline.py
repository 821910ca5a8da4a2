"""The whole method on shapes with a formula: it finds them, it repeats, it stops when asked."""

import numpy as np
import pytest
import torch
from scipy.spatial import cKDTree
from scipy.spatial.transform import Rotation

from schemas.job import Progress, Stage
from schemas.options import Base, Options
from schemas.problem import InputError
from schemas.study import ContourStudy
from schemas.vocabulary import Structure
from worker.evaluation.size import volume_ml
from worker.evaluation.topology import euler_number, is_watertight
from worker.reconstruction.observer import Cancelled
from worker.reconstruction.pipeline import reconstruct

ENDO, EPI = Structure.LV_ENDO, Structure.LV_EPI
CENTRE_MM = np.array([12.0, -30.0, 55.0])


def radial_error_mm(mesh, radius_mm: float, centre: np.ndarray = CENTRE_MM) -> np.ndarray:
    return np.abs(np.linalg.norm(mesh.vertices_mm - centre, axis=1) - radius_mm)


def test_spheres_come_back_as_spheres(concentric_spheres, quick: Options) -> None:
    (frame,) = reconstruct(concentric_spheres(), quick).frames
    for structure, radius_mm in ((ENDO, 25.0), (EPI, 35.0)):
        mesh = frame.surfaces[structure]
        assert is_watertight(mesh)
        assert euler_number(mesh) == 2
        assert radial_error_mm(mesh, radius_mm).mean() < 0.5
        assert volume_ml(mesh) == pytest.approx(4e-3 / 3 * np.pi * radius_mm**3, rel=0.03)


def test_same_seed_same_mesh_other_seed_other_mesh(concentric_spheres, quick: Options) -> None:
    study = concentric_spheres()
    a, b = (reconstruct(study, quick).frames[0].surfaces[ENDO] for _ in range(2))
    np.testing.assert_array_equal(a.vertices_mm, b.vertices_mm)
    np.testing.assert_array_equal(a.faces, b.faces)
    other = reconstruct(study, quick.model_copy(update={"seed": 1})).frames[0].surfaces[ENDO]
    assert other.vertices_mm.shape != a.vertices_mm.shape or not np.array_equal(
        other.vertices_mm, a.vertices_mm
    )


def test_a_study_moved_and_turned_gives_the_mesh_moved_and_turned(
    concentric_spheres, quick: Options
) -> None:
    turn = Rotation.from_rotvec([0.4, -1.1, 2.0]).as_matrix()
    moved = {3: (2.0, 1.0), 6: (-1.0, 2.0)}  # breaks the symmetry, which leaves axes undefined
    here, there = np.zeros(3), np.array([90.0, 80.0, -70.0])
    plain = concentric_spheres(displacements=moved, centre=tuple(here))
    turned = concentric_spheres(displacements=moved, centre=tuple(there), rotation=turn)
    a = reconstruct(plain, quick).frames[0].surfaces[ENDO]
    b = reconstruct(turned, quick).frames[0].surfaces[ENDO]
    assert volume_ml(a) == pytest.approx(volume_ml(b), rel=2e-3)
    away, _ = cKDTree(a.vertices_mm @ turn.T + there).query(b.vertices_mm)
    assert away.mean() < 0.1 * quick.mesh.grid_mm


@pytest.mark.slow
def test_more_levels_come_closer(concentric_spheres) -> None:
    def error(levels: int) -> float:
        options = Options.model_validate(
            {"levels": levels, "iterations_per_level": 60, "mesh": {"grid_mm": 3.0}}
        )
        mesh = reconstruct(concentric_spheres(), options).frames[0].surfaces[EPI]
        return float(radial_error_mm(mesh, 35.0).mean())

    one, three, six = error(1), error(3), error(6)
    assert one > three > six
    assert six < 0.3


@pytest.mark.slow
def test_breath_hold_shifts_are_found(concentric_spheres) -> None:
    rng = np.random.default_rng(4)
    displacements = {k: tuple(rng.normal(0.0, 2.5, 2)) for k in range(10)}
    study = concentric_spheres(displacements=displacements, centre=(0.0, 0.0, 0.0))
    (frame,) = reconstruct(study, Options()).frames
    sax = [s for s in frame.slices if s.view == "sax" and s.contours_mm]
    given = np.array([[*displacements[int(s.id[-2:])], 0.0] for s in sax])
    found = np.array([s.shift_mm for s in sax])
    before = np.sqrt((given**2).sum(axis=1).mean())
    after = np.sqrt(((found - given) ** 2).sum(axis=1).mean())
    assert after < 0.25 * before
    assert radial_error_mm(frame.surfaces[EPI], 35.0, np.zeros(3)).mean() < 0.4
    unaligned = Options(align_slices=False)
    (stubborn,) = reconstruct(study, unaligned).frames
    assert not any(np.any(s.shift_mm) for s in stubborn.slices)


def test_remeshing_keeps_the_surface_and_evens_the_triangles(
    concentric_spheres, quick: Options
) -> None:
    options = quick.model_copy(update={"target_edge_mm": 4.0, "surfaces": [EPI]})
    mesh = reconstruct(concentric_spheres(), options).frames[0].surfaces[EPI]
    assert is_watertight(mesh)
    assert euler_number(mesh) == 2
    edges = np.linalg.norm(mesh.triangles_mm - np.roll(mesh.triangles_mm, 1, axis=1), axis=2)
    assert np.median(edges) == pytest.approx(4.0, rel=0.15)


def test_open_base_is_open(concentric_spheres, quick: Options) -> None:
    options = quick.model_copy(update={"base": Base.OPEN})
    mesh = reconstruct(concentric_spheres(), options).frames[0].surfaces[ENDO]
    assert not is_watertight(mesh)


def test_an_open_base_that_cannot_be_found_is_found_out_before_the_fit(
    concentric_spheres, quick: Options
) -> None:
    document = concentric_spheres().model_dump(mode="json")
    frame = document["frames"][0]
    frame["slices"] = [s for s in frame["slices"] if s["view"] != "sax"]
    study = ContourStudy.model_validate(document)
    watcher = Watcher()
    with pytest.raises(InputError, match="open base"):
        reconstruct(study, quick.model_copy(update={"base": Base.OPEN}), watcher)
    assert not watcher.seen


def test_the_heart_of_a_mouse_is_meshed_as_finely_as_a_mans(
    concentric_spheres, quick: Options
) -> None:
    """A cell of 3 mm is wider than this whole heart."""
    study = concentric_spheres(endo_mm=1.4, epi_mm=2.0, spacing_mm=0.5)
    mesh = reconstruct(study, quick).frames[0].surfaces[ENDO]
    assert euler_number(mesh) == 2
    assert volume_ml(mesh) == pytest.approx(4e-3 / 3 * np.pi * 1.4**3, rel=0.05)


class Watcher:
    """Counts reports, and cancels after some of them."""

    def __init__(self, cancel_after: int | None = None) -> None:
        self.seen: list[Progress] = []
        self._cancel_after = cancel_after

    def advanced(self, progress: Progress) -> None:
        self.seen.append(progress)

    def is_cancelled(self) -> bool:
        return self._cancel_after is not None and len(self.seen) >= self._cancel_after


def test_progress_rises_through_the_stages(concentric_spheres, quick: Options) -> None:
    watcher = Watcher()
    reconstruct(concentric_spheres(), quick, watcher)
    fractions = [p.fraction for p in watcher.seen]
    assert fractions == sorted(fractions)
    assert fractions[-1] == pytest.approx(1.0)
    assert watcher.seen[0].stage is Stage.FITTING
    assert watcher.seen[-1].stage is Stage.MESHING
    fitting = [p for p in watcher.seen if p.stage is Stage.FITTING]
    assert len(fitting) == quick.levels * quick.iterations_per_level
    assert {p.frame for p in watcher.seen} == {"ED"}


@pytest.mark.parametrize("after", [1, 50, 181])
def test_cancellation_is_honoured_at_the_next_step(
    concentric_spheres, quick: Options, after: int
) -> None:
    watcher = Watcher(cancel_after=after)
    with pytest.raises(Cancelled):
        reconstruct(concentric_spheres(), quick, watcher)
    assert len(watcher.seen) <= after + 1


def test_the_callers_random_state_and_threads_are_left_alone(
    concentric_spheres, quick: Options
) -> None:
    torch.manual_seed(5)
    np_state = np.random.get_state()[1].copy()
    before = torch.get_rng_state()
    threads = torch.get_num_threads()
    reconstruct(concentric_spheres(), quick)
    assert torch.equal(torch.get_rng_state(), before)
    np.testing.assert_array_equal(np.random.get_state()[1], np_state)
    assert torch.get_num_threads() == threads
