"""Shifts start where the evidence says, move what it holds, and nothing else."""

from dataclasses import replace

import numpy as np
import pytest
import torch

from schemas.study import ContourStudy
from schemas.vocabulary import Structure, View
from worker.reconstruction.alignment import SliceShifts
from worker.reconstruction.crossings import crossing_evidence
from worker.reconstruction.motion import moved_back
from worker.reconstruction.normalisation import normalise
from worker.reconstruction.samples import NO_SLICE
from worker.reconstruction.shift_evidence import ShiftEvidence, no_evidence
from worker.reconstruction.stacking import build_stack
from worker.reconstruction.unit_stack import UnitStack

PRIOR = 0.05


def stack_of(study: ContourStudy) -> UnitStack:
    return normalise(build_stack(study, study.frames[0]))[0]


def movers(stack: UnitStack) -> np.ndarray:
    return np.array([s.view is View.SAX and bool(s.outlines) for s in stack.slices])


def still(stack: UnitStack, limit: float = 0.2, *, turning: bool = False) -> SliceShifts:
    return SliceShifts(stack, no_evidence(len(stack.slices), PRIOR), limit, turning=turning)


def moved_at_random(shifts: SliceShifts, sd: float, seed: int = 0) -> SliceShifts:
    generator = torch.Generator().manual_seed(seed)
    with torch.no_grad():
        shifts.in_plane.normal_(0.0, sd, generator=generator)
        if shifts.turns.requires_grad:
            shifts.turns.normal_(0.0, sd, generator=generator)
    shifts.restrain()
    return shifts


def test_long_axis_slices_and_samples_of_no_slice_stay(concentric_spheres) -> None:
    stack = stack_of(concentric_spheres())
    shifts = still(stack, turning=True)
    with torch.no_grad():
        shifts.in_plane.fill_(0.1)
        shifts.turns.fill_(0.1)
    shifts.restrain()
    found = shifts.found()
    lengths = np.linalg.norm(found.shifts, axis=1)
    np.testing.assert_allclose(lengths, np.where(movers(stack), 0.1 * np.sqrt(2), 0.0), atol=1e-6)
    np.testing.assert_allclose(found.turns, np.where(movers(stack), 0.1, 0.0), atol=1e-6)
    points = torch.rand(4, 3)
    stay = torch.full((4,), NO_SLICE)
    torch.testing.assert_close(shifts.aligned(points, stay), points)


def test_shifts_are_in_plane_and_limited(concentric_spheres) -> None:
    stack = stack_of(concentric_spheres())
    found = moved_at_random(still(stack, turning=True), 1.0).found()
    for slice_, shift in zip(stack.slices, found.shifts, strict=True):
        assert shift @ slice_.normal == pytest.approx(0.0, abs=1e-6)
        assert np.linalg.norm(shift) <= 0.2 + 1e-6
    assert np.abs(found.turns).max() == pytest.approx(np.radians(20.0))


def test_without_long_axis_slices_smooth_profiles_are_left_to_anatomy(
    concentric_spheres,
) -> None:
    stack = stack_of(concentric_spheres(long_axis=False))
    heights = np.array([s.origin @ stack.slices[0].normal for s in stack.slices])
    assert movers(stack).sum() == len(heights) - 1  # the lowest slice misses the heart
    shifts = still(stack)
    slope = torch.as_tensor(heights, dtype=torch.float32)[:, None]
    wobble = 0.02 * torch.cos(torch.arange(len(heights)) * 2.5)[:, None]
    with torch.no_grad():
        shifts.in_plane.copy_(0.03 + 0.02 * slope - 0.04 * slope**2 + 0.03 * slope**3 + wobble)
    shifts.restrain()
    found = shifts.in_plane.detach().numpy()
    for degree in range(4):
        np.testing.assert_allclose(heights**degree @ found, 0.0, atol=1e-5)
    assert np.abs(found).max() > 0.01


def test_one_long_axis_slice_holds_one_direction(concentric_spheres) -> None:
    document = concentric_spheres().model_dump(mode="json")
    document["frames"][0]["slices"] = [
        s for s in document["frames"][0]["slices"] if s["view"] != "lax_2ch"
    ]
    stack = stack_of(ContourStudy.model_validate(document))
    long_axis = next(s for s in stack.slices if s.view is not View.SAX)
    shifts = still(stack, 0.5)
    with torch.no_grad():
        shifts.in_plane.fill_(0.05)
    shifts.restrain()
    moved = shifts.found().shifts[movers(stack)]
    across = moved @ long_axis.normal
    within = moved @ np.cross(long_axis.normal, stack.slices[0].normal)
    np.testing.assert_allclose(across, 0.0, atol=1e-6)
    assert np.abs(within).min() > 0.01


def penalty_of(stack: UnitStack, slice_index: int, amount: float) -> float:
    shifts = still(stack)
    with torch.no_grad():
        shifts.in_plane[slice_index, 0] = amount
    return shifts.penalty().item()


def test_departing_costs_as_the_square_of_standard_deviations(concentric_spheres) -> None:
    stack = stack_of(concentric_spheres())
    index = int(np.flatnonzero(movers(stack))[0])
    once = penalty_of(stack, index, PRIOR)
    assert penalty_of(stack, index, 0.0) == 0.0
    assert once > 0.0
    assert penalty_of(stack, index, 2.0 * PRIOR) == pytest.approx(4.0 * once)
    # Half a square, weighted, as a mean over the slices that are free.
    assert once == pytest.approx(2e-4 * 0.5 / movers(stack).sum())
    assert penalty_of(stack, len(stack.slices) - 1, PRIOR) == 0.0  # a long-axis slice


def test_departing_costs_by_the_precision_of_each_direction(concentric_spheres) -> None:
    stack = stack_of(concentric_spheres())
    evidence = crossing_evidence(stack, 0.1, 0.007, turning=True)
    shifts = SliceShifts(stack, evidence, 0.4, turning=True)
    assert shifts.penalty().item() == pytest.approx(0.0, abs=1e-9)
    departure = np.array([0.02, -0.01, 0.05])
    with torch.no_grad():
        shifts.in_plane[4] += torch.tensor(departure[:2])
        shifts.turns[4] += departure[2]
    expected = departure @ evidence.precision[4] @ departure
    assert shifts.penalty().item() == pytest.approx(1e-4 * expected / movers(stack).sum(), rel=1e-3)


def test_short_outlines_are_held_firmer_where_no_long_axis_slice_holds_them(
    concentric_spheres,
) -> None:
    with_long_axis, without = (
        stack_of(concentric_spheres(long_axis=long_axis)) for long_axis in (True, False)
    )
    sizes = [
        sum(np.ptp(o.points) for found in s.outlines.values() for o in found)
        for s in without.slices
    ]
    shown = np.flatnonzero(movers(without))
    longest, shortest = max(shown, key=sizes.__getitem__), min(shown, key=sizes.__getitem__)
    costs = [penalty_of(without, int(k), PRIOR) for k in (longest, shortest)]
    assert costs[1] > 3.0 * costs[0]
    costs = [penalty_of(with_long_axis, int(k), PRIOR) for k in (longest, shortest)]
    assert costs[1] == pytest.approx(costs[0])


def test_slices_without_outlines_of_what_is_fitted_neither_move_nor_count(
    concentric_spheres,
) -> None:
    """Two slices cannot tell shifts from anatomy; ten without outlines are no help."""
    stack = stack_of(concentric_spheres(endo_mm=9.0, epi_mm=44.0, long_axis=False))
    shown = stack.showing([Structure.LV_ENDO])
    assert sum(bool(s.outlines) for s in shown.slices) == 2
    assert all(a.absent == b.absent for a, b in zip(shown.slices, stack.slices, strict=True))
    shifts = moved_at_random(still(shown, 0.5), 0.1)
    np.testing.assert_allclose(shifts.found().shifts, 0.0, atol=1e-6)


def evidence_at(stack: UnitStack, motion: np.ndarray, *, displaced: bool = True) -> ShiftEvidence:
    count = len(stack.slices)
    nothing = no_evidence(count, PRIOR)
    return replace(nothing, motion=motion, displaced=displaced)


def test_shifts_start_at_the_evidence(concentric_spheres) -> None:
    stack = stack_of(concentric_spheres(displacements={3: (3.0, -2.0), 6: (-1.0, 2.0)}))
    evidence = crossing_evidence(stack, 0.1, 0.007)
    shifts = SliceShifts(stack, evidence, 0.4)
    assert shifts.moving
    np.testing.assert_allclose(shifts.in_plane.detach().numpy(), evidence.motion[:, :2], atol=1e-6)
    assert shifts.penalty().item() == 0.0
    assert not still(stack).moving


def test_what_evidence_cannot_know_is_taken_out_of_it_and_costs_nothing(
    concentric_spheres,
) -> None:
    stack = stack_of(concentric_spheres(long_axis=False))
    motion = np.zeros((len(stack.slices), 3))
    motion[:, :2] = 0.03
    shifts = SliceShifts(stack, evidence_at(stack, motion), 0.4)
    np.testing.assert_allclose(shifts.found().shifts, 0.0, atol=1e-6)
    assert shifts.penalty().item() == pytest.approx(0.0, abs=1e-9)


def test_evidence_of_turns_is_nothing_to_slices_that_do_not_turn(concentric_spheres) -> None:
    stack = stack_of(concentric_spheres())
    motion = np.full((len(stack.slices), 3), 1e-3)
    for turning in (False, True):
        shifts = SliceShifts(stack, evidence_at(stack, motion), 0.4, turning=turning)
        expected = np.where(movers(stack), 1e-3, 0.0) * turning
        np.testing.assert_allclose(shifts.found().turns, expected, rtol=1e-6)


@pytest.mark.parametrize("turning", [False, True])
def test_aligned_is_moved_back_by_what_is_found(concentric_spheres, turning: bool) -> None:
    stack = stack_of(concentric_spheres(displacements={3: (3.0, -2.0), 6: (-1.0, 2.0)}))
    shifts = moved_at_random(still(stack, turning=turning), 0.1)
    found = shifts.found()
    assert found.turns.any() == turning
    for index, slice_ in enumerate(stack.slices):
        points = slice_.lift(np.random.default_rng(index).uniform(-1.0, 1.0, (20, 2)))
        aligned = shifts.aligned(
            torch.as_tensor(points, dtype=torch.float32), torch.full((20,), index)
        )
        back = moved_back(
            points, found.shifts[index], float(found.turns[index]), found.pivots[index],
            slice_.normal,
        )  # fmt: skip
        np.testing.assert_allclose(aligned.detach().numpy(), back, atol=1e-6)
        # A slice moves in its own plane.
        np.testing.assert_allclose((back - slice_.origin) @ slice_.normal, 0.0, atol=1e-6)


def test_pivots_are_the_middles_of_outlines(concentric_spheres) -> None:
    stack = stack_of(concentric_spheres(displacements={3: (3.0, -2.0)}))
    pivots = still(stack).found().pivots
    for slice_, pivot in zip(stack.slices, pivots, strict=True):
        if slice_.outlines:
            rings = [slice_.lift(o.points) for found in slice_.outlines.values() for o in found]
            np.testing.assert_allclose(pivot, np.concatenate(rings).mean(axis=0), atol=1e-6)


def test_gradients_of_aligned_points_reach_shifts_and_turns(concentric_spheres) -> None:
    stack = stack_of(concentric_spheres())
    for turning in (False, True):
        shifts = still(stack, turning=turning)
        points = torch.rand(30, 3, generator=torch.Generator().manual_seed(0))
        (shifts.aligned(points, torch.full((30,), 5)) ** 2).sum().backward()
        assert shifts.in_plane.grad is not None
        assert shifts.in_plane.grad[5].any()
        assert not shifts.in_plane.grad[[0, 1, 2, 3, 4, 6]].any()
        assert (shifts.turns.grad is not None) == turning


def test_what_evidence_has_settled_is_not_learned(concentric_spheres) -> None:
    study = concentric_spheres()
    stack, _ = normalise(build_stack(study, study.frames[0]))
    count = len(stack.slices)
    sax = np.array([s.view is View.SAX and bool(s.outlines) for s in stack.slices])
    settled = np.arange(count) % 2 == 0
    evidence = replace(evidence_at(stack, np.full((count, 3), 0.02)), settled=settled)
    shifts = SliceShifts(stack, evidence, 0.5)
    before = shifts.found().shifts
    assert shifts.moving
    with torch.no_grad():
        shifts.in_plane.add_(0.01)
    shifts.restrain()
    stayed = np.isclose(shifts.found().shifts, before, atol=1e-7).all(axis=1)
    np.testing.assert_array_equal(stayed, settled | ~sax)
    everything = replace(evidence, settled=np.ones(count, dtype=bool))
    assert not SliceShifts(stack, everything, 0.5).moving
