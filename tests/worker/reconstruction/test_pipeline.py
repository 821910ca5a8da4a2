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
from worker.evaluation.distance import surface_to_surface
from worker.evaluation.quality import triangle_quality
from worker.evaluation.size import volume_ml
from worker.evaluation.topology import euler_number, is_watertight
from worker.observer import Cancelled
from worker.phantom.analytic_heart import heart
from worker.phantom.ellipsoid import Ellipsoid
from worker.phantom.slicing import slice_meshes
from worker.phantom.slicing_plan import SlicingPlan
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
    assert frame.contour_noise_mm < 0.1
    assert stubborn.contour_noise_mm == pytest.approx(2.5, rel=0.3)


@pytest.mark.slow
def test_the_hands_of_many_slices_are_averaged() -> None:
    """What crossing outlines disagree by is measured, and not followed as if it were the heart."""
    truth = {s: m for s, m in heart(0.0).meshes(2.0).items() if s in (ENDO, EPI)}
    study = slice_meshes(truth, SlicingPlan(noise_sd_mm=1.0, seed=5)).study

    def error_mm(**loss: float) -> float:
        (frame,) = reconstruct(study, Options.model_validate({"loss": loss})).frames
        assert frame.contour_noise_mm == pytest.approx(2.0**0.5, rel=0.25)
        means = [surface_to_surface(frame.surfaces[s], truth[s]).mean_mm for s in truth]
        return float(np.mean(means))

    assert error_mm() < 0.9 * error_mm(contour_noise_mm=0.0)


def sax_fits(frame) -> list:
    return [s for s in frame.slices if s.view == "sax" and s.contours_mm]


def test_crossings_alone_align_where_the_field_may_not(concentric_spheres, quick: Options) -> None:
    """Shifts that never learn stay where the crossings put them, from the first level on."""
    displacements = {3: (4.0, -1.0), 4: (0.0, 3.0), 5: (-3.0, -2.0), 6: (2.0, 2.0), 7: (-2.0, 3.0)}
    study = concentric_spheres(displacements=displacements, centre=(0.0, 0.0, 0.0))
    options = quick.model_copy(
        update={"alignment": quick.alignment.model_copy(update={"first_level": 8})}
    )
    (frame,) = reconstruct(study, options).frames
    for slice_ in sax_fits(frame):
        given = [*displacements.get(int(slice_.id[-2:]), (0.0, 0.0)), 0.0]
        np.testing.assert_allclose(slice_.shift_mm, given, atol=0.1)
    for structure, radius_mm in ((ENDO, 25.0), (EPI, 35.0)):
        error_mm = radial_error_mm(frame.surfaces[structure], radius_mm, np.zeros(3))
        assert error_mm.mean() < 0.5


def test_a_slice_tells_what_its_shift_rests_on(concentric_spheres, quick: Options) -> None:
    displacements = {4: (3.0, -1.0), 6: (-2.0, 2.0)}
    study = concentric_spheres(displacements=displacements, centre=(0.0, 0.0, 0.0))
    (frame,) = reconstruct(study, quick).frames
    for slice_ in frame.slices:
        assert slice_.turn_rad == 0.0
        assert (slice_.shift_deviation_mm is None) == (slice_.crossings == 0)
        if slice_.view != "sax":
            assert slice_.crossings == 0
        for structure, radius_mm in ((ENDO, 25.0), (EPI, 35.0)):
            for outline in slice_.contours_mm.get(structure, ()):
                back_mm = np.linalg.norm(slice_.aligned_mm(outline.points_mm), axis=1)
                np.testing.assert_allclose(back_mm, radius_mm, atol=0.5)
    central = next(s for s in frame.slices if s.id == "sax-04")
    assert central.crossings == 8
    assert central.shift_deviation_mm == pytest.approx(0.13, abs=0.05)
    without = Options.model_validate(quick.model_dump() | {"align_slices": False})
    (unaligned,) = reconstruct(study, without).frames
    assert all(s.shift_deviation_mm is None and s.crossings == 0 for s in unaligned.slices)


def test_turns_are_found_where_they_are_asked_for(ellipsoids, quick: Options) -> None:
    motions = {3: (2.0, -1.0, 8.0), 5: (-3.0, 0.5, -6.0), 7: (1.0, 3.0, -10.0)}
    study, truth = ellipsoids(motions=motions), ellipsoids()
    turning = Options.model_validate(quick.model_dump() | {"alignment": {"rotate": True}})
    (frame,), (stiff,) = (reconstruct(study, o).frames for o in (turning, quick))
    for index, slice_ in enumerate(sax_fits(frame)[1:-1], start=1):
        degrees = motions.get(index, (0.0, 0.0, 0.0))[2]
        assert np.degrees(slice_.turn_rad) == pytest.approx(degrees, abs=1.0)
        contours = truth.frames[0].slices[index].contours
        drawn_mm = next(c.points for c in contours if c.structure is EPI)
        back_mm = slice_.aligned_mm(slice_.contours_mm[EPI][0].points_mm)
        assert np.linalg.norm(back_mm - np.array(drawn_mm), axis=1).mean() < 0.5
    assert not any(s.turn_rad for s in stiff.slices)
    volume = 4e-3 / 3 * np.pi * 36.0 * 24.0 * 44.0
    assert volume_ml(frame.surfaces[EPI]) == pytest.approx(volume, rel=0.03)
    away = {name: outside_mm(f.surfaces[EPI]) for name, f in (("free", frame), ("stiff", stiff))}
    assert away["free"] < away["stiff"]
    assert away["free"] < 0.5


def outside_mm(mesh) -> float:
    """Mean distance, to first order, to the outer ellipsoid of `ellipsoids`."""
    ellipsoid = Ellipsoid((0.0, 0.0, 0.0), (36.0, 24.0, 44.0))
    return float(np.abs(ellipsoid.signed_mm(mesh.vertices_mm)).mean())


@pytest.mark.parametrize("method", ["muon", "adam"])
def test_both_ways_to_descend_find_the_spheres(concentric_spheres, quick: Options, method) -> None:
    optimizer = {"method": method, "samples_per_step": 1024, "learning_rate": 1e-2}
    options = Options.model_validate(quick.model_dump() | {"optimizer": optimizer})
    mesh = reconstruct(concentric_spheres(), options).frames[0].surfaces[EPI]
    assert radial_error_mm(mesh, 35.0).mean() < 1.0


def test_the_published_recipe_runs(concentric_spheres) -> None:
    options = Options.model_validate(
        {"preset": "paper", "levels": 3, "iterations_per_level": 60, "mesh": {"grid_mm": 3.0}}
    )
    (frame,) = reconstruct(concentric_spheres(), options).frames
    for structure, radius_mm in ((ENDO, 25.0), (EPI, 35.0)):
        assert is_watertight(frame.surfaces[structure])
        assert radial_error_mm(frame.surfaces[structure], radius_mm).mean() < 2.0
    assert not any(np.any(s.shift_mm) for s in frame.slices)


def test_remeshing_keeps_the_surface_and_evens_the_triangles(
    concentric_spheres, quick: Options
) -> None:
    options = quick.model_copy(update={"target_edge_mm": 4.0, "surfaces": [EPI]})
    (frame,) = reconstruct(concentric_spheres(), options).frames
    mesh, before = frame.surfaces[EPI], frame.unremeshed[EPI]
    assert is_watertight(mesh)
    assert euler_number(mesh) == 2
    quality = triangle_quality(mesh)
    assert quality.edge_mean_mm == pytest.approx(4.0, rel=0.1)
    assert quality.below_20_deg_percent == 0.0
    assert triangle_quality(before).below_20_deg_percent > 5.0
    assert surface_to_surface(mesh, before, 4000).hausdorff95_mm < 0.2
    assert volume_ml(mesh) == pytest.approx(volume_ml(before), rel=5e-3)


def test_surfaces_are_only_kept_twice_where_they_are_remeshed(
    concentric_spheres, quick: Options
) -> None:
    (frame,) = reconstruct(concentric_spheres(), quick).frames
    assert frame.unremeshed == {}


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
