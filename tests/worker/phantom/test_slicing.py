import numpy as np
import pytest

from schemas.problem import InputError
from schemas.study import ContourStudy, Frame
from schemas.vocabulary import Axes, Structure, View
from worker.evaluation.distance import points_to_surface_mm
from worker.phantom import SlicingPlan, slice_frames, slice_meshes
from worker.surface_mesh import SurfaceMesh


def points_of(frame: Frame, structure: Structure) -> np.ndarray:
    return np.concatenate(
        [c.points for s in frame.slices for c in s.contours if c.structure is structure]
    )


def test_contours_lie_on_the_surfaces_and_in_their_planes(diastole):
    study = slice_meshes(diastole).study
    (frame,) = study.frames
    for structure, mesh in diastole.items():
        assert points_to_surface_mm(points_of(frame, structure), mesh).max() < 2e-4
    for one in frame.slices:
        points = np.concatenate([c.points for c in one.contours])
        assert np.abs((points - np.array(one.origin)) @ np.array(one.normal)).max() < 2e-4


def test_the_study_is_a_valid_one_with_every_view(diastole):
    study = slice_meshes(diastole, SlicingPlan(spacing_mm=10.0), axes=Axes.RAS).study
    assert ContourStudy.model_validate_json(study.model_dump_json()) == study
    assert study.axes is Axes.RAS
    views = [s.view for s in study.frames[0].slices]
    assert views.count(View.SAX) == 9
    assert views[-3:] == [View.LAX_4CH, View.LAX_2CH, View.LAX_3CH]
    assert study.frames[0].slices[0].id == "sax-00"


def test_every_structure_is_observed_or_absent_on_every_slice(diastole):
    study = slice_meshes(diastole, SlicingPlan(margin_mm=8.0)).study
    for one in study.frames[0].slices:
        observed = {c.structure for c in one.contours}
        assert observed | set(one.absent) == set(diastole)
        assert not observed & set(one.absent)


def test_the_margin_makes_one_empty_slice_at_each_end(diastole):
    slices = (
        slice_meshes(diastole, SlicingPlan(margin_mm=8.0, long_axis_planes=0))
        .study.frames[0]
        .slices
    )
    empty = [not s.contours for s in slices]
    assert empty == [True] + [False] * (len(slices) - 2) + [True]
    assert set(slices[0].absent) == set(diastole)


def test_no_plane_is_made_beyond_the_surfaces_of_a_frame(diastole, systole):
    study = slice_frames({"ED": diastole, "ES": systole}).study
    rest, squeezed = study.frames
    assert {s.id for s in squeezed.slices} < {s.id for s in rest.slices}
    assert all(s.contours for f in study.frames for s in f.slices)


def test_frames_share_planes_and_displacements(diastole, systole):
    plan = SlicingPlan(shift_sd_mm=3.0, seed=5)
    sliced = slice_frames({"ED": diastole, "ES": systole}, plan)
    rest, squeezed = ({s.id: s for s in f.slices} for f in sliced.study.frames)
    for name, one in squeezed.items():
        assert (one.origin, one.normal) == (rest[name].origin, rest[name].normal)


def test_frames_tell_the_times_that_are_known(diastole, systole):
    frames = {"ED": diastole, "ES": systole}
    study = slice_frames(frames, times_ms={"ES": 351.0}).study
    assert [frame.time_ms for frame in study.frames] == [None, 351.0]


def test_true_shifts_are_what_was_added(diastole):
    still = slice_meshes(diastole).study.frames[0].slices
    moved = slice_meshes(diastole, SlicingPlan(shift_sd_mm=3.0))
    for before, after in zip(still, moved.study.frames[0].slices, strict=True):
        shift = moved.true_shifts_mm[after.id]
        for was, now in zip(before.contours, after.contours, strict=True):
            np.testing.assert_allclose(
                np.array(now.points) - was.points, np.tile(shift, (len(now.points), 1)), atol=2e-4
            )
        assert abs(shift @ np.array(after.normal)) < 1e-6
        assert (np.linalg.norm(shift) > 0.0) == (after.view is View.SAX)


def test_shifts_have_the_standard_deviation_asked_for(sphere):
    plans = [SlicingPlan(spacing_mm=1.0, shift_sd_mm=3.0, seed=seed) for seed in range(5)]
    shifts = np.array(
        [
            shift
            for plan in plans
            for name, shift in slice_meshes(
                {Structure.LV_ENDO: sphere}, plan
            ).true_shifts_mm.items()
            if name.startswith("sax")
        ]
    )
    assert len(shifts) > 150
    # Two in-plane components of 3 mm each.
    assert np.sqrt(np.mean(np.sum(shifts**2, axis=1)) / 2.0) == pytest.approx(3.0, rel=0.1)


def test_noise_moves_points_in_their_plane_by_its_deviation(diastole):
    study = slice_meshes(diastole, SlicingPlan(noise_sd_mm=0.5)).study
    distance = points_to_surface_mm(
        points_of(study.frames[0], Structure.LV_EPI), diastole[Structure.LV_EPI]
    )
    assert 0.35 < np.sqrt(np.mean(distance**2)) < 0.55


def test_the_seed_decides(diastole):
    plans = [SlicingPlan(shift_sd_mm=2.0, noise_sd_mm=0.3, seed=s) for s in (1, 1, 2)]
    first, again, other = (slice_meshes(diastole, p).study for p in plans)
    assert first == again
    assert first != other


def test_several_loops_of_one_structure_are_several_contours(torus):
    plan = SlicingPlan(spacing_mm=10.0, axis=(1.0, 0.0, 0.0), long_axis_planes=0)
    slices = slice_meshes({Structure.LV_ENDO: torus}, plan).study.frames[0].slices
    assert [len(s.contours) for s in slices] == [1, 2, 2, 2, 1]


def test_an_open_surface_is_refused_by_name(diastole):
    mesh = diastole[Structure.LV_ENDO]
    holed = SurfaceMesh(mesh.vertices_mm, mesh.faces[1:])
    with pytest.raises(InputError, match=r"ED lv_endo is not closed.*fill its holes"):
        slice_meshes({Structure.LV_ENDO: holed})


def test_nothing_to_slice_is_refused():
    with pytest.raises(InputError, match="at least one surface"):
        slice_frames({})


def test_a_bad_name_is_refused(diastole):
    with pytest.raises(InputError, match="subject_id"):
        slice_meshes(diastole, subject_id="a/b")


@pytest.mark.parametrize(
    "wrong",
    [
        {"spacing_mm": 0.0},
        {"margin_mm": 9.0},
        {"long_axis_planes": 4},
        {"point_spacing_mm": -1.0},
        {"shift_sd_mm": float("nan")},
        {"noise_sd_mm": 100.0},
    ],
)
def test_a_plan_out_of_bounds_is_refused(wrong):
    (name,) = wrong
    with pytest.raises(InputError, match=f"{name}.*choose between"):
        SlicingPlan(**wrong)


def test_an_axis_without_direction_is_refused():
    with pytest.raises(InputError, match="zero vector"):
        SlicingPlan(axis=(0.0, 0.0, 0.0))
