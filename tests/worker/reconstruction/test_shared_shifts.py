"""One shift a slice from all frames: nearer the truth than from one, and the same for each."""

import numpy as np
import pytest

from schemas.study import ContourStudy
from worker.phantom.analytic_heart import heart
from worker.phantom.slicing import SlicedStudy, slice_frames
from worker.phantom.slicing_plan import SlicingPlan
from worker.reconstruction.crossings import crossing_evidence
from worker.reconstruction.normalisation import UnitFrame, normalised, unit_frame_of
from worker.reconstruction.shared_shifts import SharedShifts, share_planes, shared_shifts
from worker.reconstruction.slice_stack import SliceStack
from worker.reconstruction.stacking import build_stack
from worker.reconstruction.unit_stack import UnitStack

PRIOR_MM, NOISE_MM = 3.0, 0.25
FRAMES = 6


def sliced(shift_sd_mm: float, noise_sd_mm: float) -> SlicedStudy:
    """The same heart, drawn anew in each frame."""
    meshes = heart().meshes(2.0)
    plan = SlicingPlan(shift_sd_mm=shift_sd_mm, noise_sd_mm=noise_sd_mm, seed=4)
    return slice_frames({f"F{index}": meshes for index in range(FRAMES)}, plan)


def stacks_of(study: ContourStudy) -> tuple[list[UnitStack], UnitFrame]:
    in_mm = [build_stack(study, frame) for frame in study.frames]
    frame = unit_frame_of(SliceStack("", None, tuple(s for one in in_mm for s in one.slices)))
    return [normalised(one, frame) for one in in_mm], frame


def shared_by(stacks: list[UnitStack], frame: UnitFrame) -> SharedShifts:
    unit_mm = frame.half_extent_mm
    found = shared_shifts(stacks, PRIOR_MM / unit_mm, NOISE_MM / unit_mm)
    assert found is not None
    return found


def errors_mm(
    stack: UnitStack, motion: np.ndarray, frame: UnitFrame, given: dict[str, np.ndarray]
) -> list[float]:
    return [
        float(np.linalg.norm(frame.displacement_to_mm((m[:2] @ one.axes)[None])[0] - given[one.id]))
        for one, m in zip(stack.slices, motion, strict=True)
        if one.id.startswith("sax") and one.outlines
    ]


def test_all_frames_together_find_shifts_better_than_each_alone() -> None:
    made = sliced(shift_sd_mm=3.0, noise_sd_mm=1.0)
    stacks, frame = stacks_of(made.study)
    shared = shared_by(stacks, frame)
    unit_mm = frame.half_extent_mm
    alone = np.mean(
        [
            errors_mm(
                stack,
                crossing_evidence(stack, PRIOR_MM / unit_mm, NOISE_MM / unit_mm).motion,
                frame,
                made.true_shifts_mm,
            )
            for stack in stacks
        ]
    )
    together = np.mean(
        errors_mm(stacks[0], shared.of(stacks[0]).motion, frame, made.true_shifts_mm)
    )
    assert together < 0.7 * alone
    # Every frame's hand is a new one here.
    assert shared.dependence < 2.0
    assert not shared.disagreements


def test_frames_whose_errors_are_the_same_count_as_one() -> None:
    made = sliced(shift_sd_mm=3.0, noise_sd_mm=1.0)
    stacks, frame = stacks_of(made.study)
    copies = [stacks[0]] * FRAMES
    shared = shared_by(copies, frame)
    unit_mm = frame.half_extent_mm
    one = crossing_evidence(stacks[0], PRIOR_MM / unit_mm, NOISE_MM / unit_mm)
    assert shared.dependence == pytest.approx(FRAMES)
    np.testing.assert_allclose(
        shared.of(stacks[0]).deviations(), one.deviations(), rtol=0.35, equal_nan=True
    )


def test_a_frame_that_places_a_slice_elsewhere_is_named() -> None:
    made = sliced(shift_sd_mm=0.0, noise_sd_mm=0.25)
    document = made.study.model_dump(mode="json")
    moved = document["frames"][2]["slices"][5]
    normal = np.array(moved["normal"])
    aside = np.cross(normal, np.eye(3)[int(np.argmin(np.abs(normal)))])
    aside *= 5.0 / np.linalg.norm(aside)
    for contour in moved["contours"]:
        contour["points"] = (np.array(contour["points"]) + aside).tolist()
    stacks, frame = stacks_of(ContourStudy.model_validate(document))
    (one,) = shared_by(stacks, frame).disagreements
    assert (one.slice_id, one.frames) == (moved["id"], (2,))
    assert 2.0 < one.furthest * frame.half_extent_mm < 6.0


def test_where_nothing_crosses_frames_have_nothing_to_join(concentric_spheres) -> None:
    stacks, _ = stacks_of(concentric_spheres(long_axis=False))
    assert shared_shifts(stacks * 3, 0.1, 0.007) is None


def test_slices_of_one_id_share_a_shift_only_in_one_plane() -> None:
    document = sliced(0.0, 0.0).study.model_dump(mode="json")
    assert share_planes(stacks_of(ContourStudy.model_validate(document))[0])
    other = document["frames"][1]["slices"][4]
    step = 8.0 * np.array(other["normal"])
    other["origin"] = (np.array(other["origin"]) + step).tolist()
    for contour in other["contours"]:
        contour["points"] = (np.array(contour["points"]) + step).tolist()
    assert not share_planes(stacks_of(ContourStudy.model_validate(document))[0])


def test_what_one_fit_found_holds_for_every_frame() -> None:
    stacks, frame = stacks_of(sliced(3.0, 0.5).study)
    shared = shared_by(stacks, frame)
    learned = shared.motion_of(stacks[0]).shifts + 0.01 * stacks[0].slices[0].axes[0]
    final = shared.found(stacks[0], learned)
    assert final.evidence.final
    by_id = dict(
        zip([one.id for one in stacks[0].slices], final.motion_of(stacks[0]).shifts, strict=True)
    )
    for stack in stacks:
        for one, shift in zip(stack.slices, final.motion_of(stack).shifts, strict=True):
            np.testing.assert_array_equal(shift, by_id[one.id])
