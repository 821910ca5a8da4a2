"""Displacements that were put in come out again where long-axis outlines cross, and only there."""

from collections.abc import Callable
from typing import Any

import numpy as np
import pytest

from schemas.study import ContourStudy
from schemas.vocabulary import Structure, View
from worker.phantom.analytic_heart import heart
from worker.phantom.slicing import SlicedStudy, slice_meshes
from worker.phantom.slicing_plan import SlicingPlan
from worker.reconstruction.crossings import crossing_evidence
from worker.reconstruction.motion import moved_back
from worker.reconstruction.normalisation import normalise
from worker.reconstruction.shift_evidence import ShiftEvidence, prior_precision
from worker.reconstruction.stacking import build_stack
from worker.reconstruction.unit_stack import UnitStack

PRIOR_MM, NOISE_MM = 3.0, 0.25
SHIFTS_MM = {
    1: (4.2, 1.6), 2: (-4.1, 0.0), 3: (-1.6, 0.4), 4: (-4.0, 0.6), 5: (0.6, 3.9),
    6: (0.8, 1.3), 7: (-3.7, 5.6), 8: (2.8, -2.7), 9: (-0.8, -2.2),
}  # fmt: skip
"""Of slices of concentric spheres; slice 0 lies below them."""


class Found:
    """What crossings say of a study, in mm and by slice id."""

    def __init__(self, study: ContourStudy, *, turning: bool = False) -> None:
        self.stack, self.frame = normalise(build_stack(study, study.frames[0]))
        self.unit_mm = self.frame.half_extent_mm
        prior, noise = PRIOR_MM / self.unit_mm, NOISE_MM / self.unit_mm
        self.evidence = crossing_evidence(self.stack, prior, noise, turning=turning)
        shifts = self.frame.displacement_to_mm(in_space(self.stack, self.evidence))
        ids = [s.id for s in self.stack.slices]
        self.shifts_mm = dict(zip(ids, shifts, strict=True))
        self.crossings = dict(zip(ids, self.evidence.crossings.tolist(), strict=True))
        deviations_mm = self.unit_mm * self.evidence.deviations()
        self.deviations_mm = dict(zip(ids, deviations_mm.tolist(), strict=True))
        self.turns_deg = dict(zip(ids, np.degrees(self.evidence.motion[:, 2]), strict=True))
        self.prior_sd_mm = dict(
            zip(ids, self.unit_mm * self.evidence.precision[:, 0, 0] ** -0.5, strict=True)
        )


def in_space(stack: UnitStack, evidence: ShiftEvidence) -> np.ndarray:
    axes = np.array([s.axes for s in stack.slices])
    return np.einsum("ka,kad->kd", evidence.motion[:, :2], axes)


def errors_mm(found: Found, given: dict[int, tuple[float, float]]) -> dict[int, float]:
    return {
        k: float(np.linalg.norm(found.shifts_mm[f"sax-{k:02d}"] - [*shift, 0.0]))
        for k, shift in given.items()
    }


def edited(study: ContourStudy, edit: Callable[[dict[str, Any]], None]) -> ContourStudy:
    """The study after `edit` of every slice's document."""
    document = study.model_dump(mode="json")
    for slice_ in document["frames"][0]["slices"]:
        edit(slice_)
    return ContourStudy.model_validate(document)


def long_axis_without(structure: str) -> Callable[[dict[str, Any]], None]:
    def edit(slice_: dict[str, Any]) -> None:
        if slice_["view"] != "sax":
            slice_["contours"] = [c for c in slice_["contours"] if c["structure"] != structure]

    return edit


def test_shifts_of_spheres_are_found(concentric_spheres) -> None:
    found = Found(concentric_spheres(displacements=SHIFTS_MM, centre=(0.0, 0.0, 0.0)))
    errors = errors_mm(found, SHIFTS_MM)
    # The last slice grazes the sphere: what crosses it there runs along its plane.
    assert max(error for k, error in errors.items() if k != 9) < 0.1
    assert errors[9] < 0.5
    assert all(errors[k] < found.deviations_mm[f"sax-{k:02d}"] for k in errors)
    assert found.evidence.displaced
    assert [found.crossings[f"sax-{k:02d}"] for k in range(10)] == [0, 4, 8, 8, 8, 8, 8, 8, 4, 4]


def test_an_aligned_stack_is_left_alone(concentric_spheres) -> None:
    found = Found(concentric_spheres())
    assert max(np.linalg.norm(shift) for shift in found.shifts_mm.values()) < 0.01


@pytest.fixture(scope="module")
def displaced_heart() -> Callable[[int], SlicedStudy]:
    meshes = heart().meshes(2.0)
    return lambda planes: slice_meshes(
        meshes, SlicingPlan(shift_sd_mm=2.5, long_axis_planes=planes, seed=3)
    )


@pytest.mark.parametrize("planes", [2, 3])
def test_shifts_of_a_heart_are_found(
    displaced_heart: Callable[[int], SlicedStudy], planes: int
) -> None:
    sliced = displaced_heart(planes)
    found = Found(sliced.study)
    errors = {
        name: np.linalg.norm(found.shifts_mm[name] - shift)
        for name, shift in sliced.true_shifts_mm.items()
    }
    *inner, apex = [name for name in errors if name.startswith("sax")]
    assert max(errors[name] for name in inner) < 0.02
    assert errors[apex] < 0.15
    assert all(errors[name] < found.deviations_mm[name] for name in inner)


def test_one_long_axis_plane_tells_the_shift_along_itself(concentric_spheres) -> None:
    document = concentric_spheres(displacements=SHIFTS_MM, centre=(0.0, 0.0, 0.0)).model_dump(
        mode="json"
    )
    slices = document["frames"][0]["slices"]
    document["frames"][0]["slices"] = [s for s in slices if s["view"] != "lax_2ch"]
    found = Found(ContourStudy.model_validate(document))
    # The plane that is left has x for its normal, and a circle's chord moves little with x.
    for k in range(2, 8):
        assert found.shifts_mm[f"sax-{k:02d}"][1] == pytest.approx(SHIFTS_MM[k][1], abs=0.5)
        assert found.deviations_mm[f"sax-{k:02d}"] > 0.5


def test_what_crosses_counts_the_more_the_steeper_and_adds_to_the_prior(
    concentric_spheres,
) -> None:
    """Two planes cross a circle at four points, two of them along each axis."""
    found = Found(concentric_spheres())
    heights_mm = np.array([8.0 * (k - 5) + 2.4 for k in range(10)])
    squares = sum(np.maximum(0.0, 1.0 - (heights_mm / radius) ** 2) for radius in (25.0, 35.0))
    # In an aligned stack a slice is expected where it is, to within the noise.
    expected = (2.0 * squares + 1.0) / NOISE_MM**2
    precision = found.evidence.precision[:10, :2, :2] / found.unit_mm**2
    np.testing.assert_allclose(precision[1:9, 0, 0], expected[1:9], rtol=0.05)
    np.testing.assert_allclose(precision[1:9, 1, 1], expected[1:9], rtol=0.05)
    np.testing.assert_allclose(precision[1:9, 0, 1] / expected[1:9], 0.0, atol=0.05)
    deviations = [found.deviations_mm[f"sax-{k:02d}"] for k in range(1, 9)]
    np.testing.assert_allclose(deviations, expected[1:9] ** -0.5, rtol=0.05)


@pytest.mark.parametrize(
    ("displacements", "sd_mm"), [({}, NOISE_MM), (SHIFTS_MM, 3.0), ({3: (2.0, 0.0)}, 0.51)]
)
def test_a_slice_that_nothing_crosses_is_expected_as_the_others_are(
    concentric_spheres, displacements: dict[int, tuple[float, float]], sd_mm: float
) -> None:
    """Outside the inner sphere only lv_epi is drawn, which long-axis slices here do not show."""
    study = concentric_spheres(displacements=displacements, centre=(0.0, 0.0, 0.0))
    found = Found(edited(study, long_axis_without("lv_epi")))
    for name in ("sax-00", "sax-01", "sax-08", "sax-09"):
        assert found.crossings[name] == 0
        assert np.isnan(found.deviations_mm[name])
        np.testing.assert_array_equal(found.shifts_mm[name], 0.0)
        assert found.prior_sd_mm[name] == pytest.approx(sd_mm, rel=0.15)
    assert found.prior_sd_mm["lax_4ch-00"] == pytest.approx(sd_mm, rel=0.15)


def test_disagreement_raises_the_noise_and_moves_nothing(concentric_spheres) -> None:
    """Long-axis outlines all 1 mm too wide: no shift mends that, nor are slices displaced."""

    def widen(slice_: dict[str, Any]) -> None:
        if slice_["view"] != "sax":
            for contour in slice_["contours"]:
                radius_mm = {"lv_endo": 25.0, "lv_epi": 35.0}[contour["structure"]]
                contour["points"] = (np.array(contour["points"]) * (1.0 + 1.0 / radius_mm)).tolist()

    study = concentric_spheres(centre=(0.0, 0.0, 0.0))
    right, wide = Found(study), Found(edited(study, widen))
    for k in range(2, 8):
        name = f"sax-{k:02d}"
        assert np.linalg.norm(wide.shifts_mm[name]) < 0.05
        assert right.deviations_mm[name] * 1.5 < wide.deviations_mm[name] < NOISE_MM


@pytest.mark.parametrize("offset_mm", [6.0, 12.0])
def test_a_wrong_outline_moves_no_slice_far(concentric_spheres, offset_mm: float) -> None:
    def displace(slice_: dict[str, Any]) -> None:
        if slice_["view"] == "lax_2ch":
            endo = next(c for c in slice_["contours"] if c["structure"] == "lv_endo")
            points = np.array(endo["points"]) + np.array([offset_mm, 0.0, 0.0])
            endo["points"] = points.tolist()

    found = Found(edited(concentric_spheres(centre=(0.0, 0.0, 0.0)), displace))
    assert max(np.linalg.norm(found.shifts_mm[f"sax-{k:02d}"]) for k in range(10)) < 1.0


def test_the_chord_of_an_open_outline_is_no_crossing(concentric_spheres) -> None:
    def halve(slice_: dict[str, Any]) -> None:
        if slice_["view"] != "sax":
            for contour in slice_["contours"]:
                points = np.array(contour["points"])
                beside = points[:, 0] + points[:, 1] > 0.0
                first = int(np.flatnonzero(beside & ~np.roll(beside, 1))[0])
                arc = np.roll(points, -first, axis=0)[: beside.sum()]
                contour.update(points=arc.tolist(), closed=False)

    study = concentric_spheres(centre=(0.0, 0.0, 0.0), displacements=SHIFTS_MM)
    whole, half = Found(study), Found(edited(study, halve))
    for k in range(1, 9):
        assert 2 * half.crossings[f"sax-{k:02d}"] == whole.crossings[f"sax-{k:02d}"]
    errors = errors_mm(half, SHIFTS_MM)
    assert max(errors[k] for k in range(2, 8)) < 0.1


def test_without_long_axis_slices_there_is_the_prior_alone(concentric_spheres) -> None:
    study = concentric_spheres(long_axis=False, displacements=SHIFTS_MM)
    stack, _ = normalise(build_stack(study, study.frames[0]))
    evidence = crossing_evidence(stack, 0.09, 0.007)
    assert not evidence.motion.any()
    assert not evidence.crossings.any()
    assert evidence.contour_noise is None
    assert evidence.in_place(0.09).contour_noise is None
    np.testing.assert_array_equal(
        evidence.precision, np.tile(prior_precision(0.09, False), (len(stack.slices), 1, 1))
    )


TURNS = {2: (2.0, -1.0, 8.0), 4: (-3.0, 0.5, -6.0), 5: (0.0, 0.0, 4.0), 7: (1.0, 3.0, -10.0)}


def test_turns_are_found_with_the_shifts(ellipsoids) -> None:
    found = Found(ellipsoids(motions=TURNS), turning=True)
    for k in range(2, 9):
        *shift, degrees = TURNS.get(k, (0.0, 0.0, 0.0))
        assert found.turns_deg[f"sax-{k:02d}"] == pytest.approx(degrees, abs=0.3)
        # The pivot is the middle of the outlines as drawn, so the shift is that of their middle.
        np.testing.assert_allclose(found.shifts_mm[f"sax-{k:02d}"], [*shift, 0.0], atol=0.1)


def test_found_motions_bring_outlines_back(ellipsoids) -> None:
    found, still = Found(ellipsoids(motions=TURNS), turning=True), ellipsoids()
    shifts = in_space(found.stack, found.evidence)
    for index in range(2, 9):
        slice_ = found.stack.slices[index]
        back = moved_back(
            slice_.lift(slice_.outlines[Structure.LV_EPI][0].points),
            shifts[index],
            float(found.evidence.motion[index, 2]),
            slice_.lift(slice_.pivot[None])[0],
            slice_.normal,
        )
        contours = still.frames[0].slices[index].contours
        truth_mm = next(c.points for c in contours if c.structure is Structure.LV_EPI)
        away_mm = np.linalg.norm(found.frame.to_mm(back) - np.array(truth_mm), axis=1)
        assert away_mm.max() < 0.3


def test_turns_of_an_aligned_stack_are_none(ellipsoids) -> None:
    found = Found(ellipsoids(), turning=True)
    assert max(np.abs(list(found.turns_deg.values()))) < 0.05


def test_a_slice_that_may_not_turn_does_not(ellipsoids) -> None:
    found = Found(ellipsoids(motions=TURNS))
    assert max(np.abs(list(found.turns_deg.values()))) < 0.05


def test_a_round_slice_does_not_turn(concentric_spheres) -> None:
    """Nothing but the corners of its polygon shows a turn."""
    found = Found(concentric_spheres(displacements=SHIFTS_MM), turning=True)
    assert max(np.abs(list(found.turns_deg.values()))) < 0.5


def test_where_an_open_outline_was_not_drawn_nothing_pulls(concentric_spheres) -> None:
    document = concentric_spheres().model_dump(mode="json")
    for slice_ in document["frames"][0]["slices"]:
        for contour in slice_["contours"] if slice_["view"] == "sax" else ():
            contour["points"], contour["closed"] = contour["points"][:60], False
    found = Found(ContourStudy.model_validate(document))
    middle = {k: (0.0, 0.0) for k in range(2, 9)}
    assert max(errors_mm(found, middle).values()) < 0.05


@pytest.mark.parametrize("noise_mm", [0.5, 1.0])
def test_an_unsteady_hand_is_not_taken_for_breath_holds(noise_mm: float) -> None:
    plan = SlicingPlan(noise_sd_mm=noise_mm, seed=3)
    found = Found(slice_meshes(heart(0.0).meshes(2.0), plan).study)
    assert not found.evidence.displaced
    assert not found.evidence.motion.any()
    # Both outlines that cross are unsteady.
    assert found.evidence.contour_noise * found.unit_mm == pytest.approx(
        2.0**0.5 * noise_mm, rel=0.25
    )


def test_an_unsteady_hand_hides_no_breath_holds() -> None:
    plan = SlicingPlan(noise_sd_mm=0.5, shift_sd_mm=1.5, seed=3)
    sliced = slice_meshes(heart(0.0).meshes(2.0), plan)
    found = Found(sliced.study)
    assert found.evidence.displaced
    assert found.evidence.contour_noise * found.unit_mm == pytest.approx(0.5 * 2.0**0.5, rel=0.3)
    errors = [
        np.linalg.norm(found.shifts_mm[name] - shift)
        for name, shift in sliced.true_shifts_mm.items()
        if found.crossings[name] > 3
    ]
    assert np.sqrt(np.mean(np.square(errors))) < 0.8


def test_slices_that_may_not_move_disagree_by_their_shifts(concentric_spheres) -> None:
    study = concentric_spheres(displacements=SHIFTS_MM, centre=(0.0, 0.0, 0.0))
    found = Found(study)
    still = found.evidence.in_place(0.05)
    assert not still.displaced
    assert not still.motion.any()
    crossed = [k for k in SHIFTS_MM if found.crossings[f"sax-{k:02d}"]]
    rms_mm = np.sqrt(np.mean([np.square(SHIFTS_MM[k]).mean() for k in crossed]))
    assert found.evidence.contour_noise * found.unit_mm < 0.1
    assert still.contour_noise * found.unit_mm == pytest.approx(rms_mm, rel=0.1)


def test_what_one_long_axis_slice_leaves_unseen_makes_its_shifts_no_smaller() -> None:
    plan = SlicingPlan(shift_sd_mm=3.0, long_axis_planes=1, seed=2)
    sliced = slice_meshes(heart(0.0).meshes(2.0), plan)
    found = Found(sliced.study)
    long_axis = next(s for s in found.stack.slices if s.view is not View.SAX)
    normals = found.frame.displacement_to_mm(np.array([s.normal for s in found.stack.slices[:1]]))
    across = found.frame.displacement_to_mm(long_axis.normal[None])
    seen = np.cross(across, normals)[0]
    seen /= np.linalg.norm(seen)
    crossed = [name for name, count in found.crossings.items() if count > 3]
    assert len(crossed) > 5
    for name in crossed:
        error_mm = (found.shifts_mm[name] - sliced.true_shifts_mm[name]) @ seen
        assert abs(error_mm) < 0.15
