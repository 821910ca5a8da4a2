"""Shifts move what the evidence holds, and nothing else."""

import numpy as np
import pytest
import torch

from schemas.vocabulary import Structure, View
from worker.reconstruction.alignment import SliceShifts
from worker.reconstruction.normalisation import normalise
from worker.reconstruction.samples import NO_SLICE
from worker.reconstruction.stacking import build_stack


def shifts_of(study) -> tuple[SliceShifts, list[bool], np.ndarray]:
    stack, _ = normalise(build_stack(study, study.frames[0]))
    sax = [s.view is View.SAX and bool(s.outlines) for s in stack.slices]
    heights = np.array([s.origin @ stack.slices[0].normal for s in stack.slices])
    return SliceShifts(stack, prior=0.05, limit=0.2), sax, heights


def test_long_axis_slices_and_samples_of_no_slice_stay(concentric_spheres) -> None:
    shifts, sax, _ = shifts_of(concentric_spheres())
    with torch.no_grad():
        shifts.in_plane.fill_(0.1)
    shifts.restrain()
    lengths = np.linalg.norm(shifts.found(), axis=1)
    np.testing.assert_allclose(lengths, np.where(sax, 0.1 * np.sqrt(2), 0.0), atol=1e-6)
    points = torch.rand(4, 3)
    stay = torch.full((4,), NO_SLICE)
    torch.testing.assert_close(shifts.aligned(points, stay), points)


def test_shifts_are_in_plane_and_limited(concentric_spheres) -> None:
    study = concentric_spheres()
    stack, _ = normalise(build_stack(study, study.frames[0]))
    shifts = SliceShifts(stack, prior=0.05, limit=0.2)
    with torch.no_grad():
        shifts.in_plane.normal_(0.0, 1.0, generator=torch.Generator().manual_seed(0))
    shifts.restrain()
    for slice_, shift in zip(stack.slices, shifts.found(), strict=True):
        assert shift @ slice_.normal == pytest.approx(0.0, abs=1e-6)
        assert np.linalg.norm(shift) <= 0.2 + 1e-6


def test_without_long_axis_slices_smooth_profiles_are_left_to_anatomy(
    concentric_spheres,
) -> None:
    shifts, sax, heights = shifts_of(concentric_spheres(long_axis=False))
    assert sum(sax) == len(sax) - 1  # the lowest slice misses the heart
    slope = torch.as_tensor(heights, dtype=torch.float32)[:, None]
    wobble = 0.02 * torch.cos(torch.arange(len(sax)) * 2.5)[:, None]
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
    study = type(concentric_spheres()).model_validate(document)
    stack, _ = normalise(build_stack(study, study.frames[0]))
    long_axis = next(s for s in stack.slices if s.view is not View.SAX)
    shifts = SliceShifts(stack, prior=0.05, limit=0.5)
    with torch.no_grad():
        shifts.in_plane.fill_(0.05)
    shifts.restrain()
    movers = [i for i, s in enumerate(stack.slices) if s.view is View.SAX and s.outlines]
    across = shifts.found()[movers] @ long_axis.normal
    within = shifts.found()[movers] @ np.cross(long_axis.normal, stack.slices[0].normal)
    np.testing.assert_allclose(across, 0.0, atol=1e-6)
    assert np.abs(within).min() > 0.01


def test_prior_grows_with_the_square_and_with_the_shortness_of_outlines(
    concentric_spheres,
) -> None:
    study = concentric_spheres()
    stack, _ = normalise(build_stack(study, study.frames[0]))
    sizes = [
        sum(np.ptp(o.points) for found in s.outlines.values() for o in found) for s in stack.slices
    ]

    def cost(slice_index: int, amount: float) -> float:
        shifts = SliceShifts(stack, prior=0.05, limit=0.2)
        with torch.no_grad():
            shifts.in_plane[slice_index] = amount
        return shifts.negative_log_prior().item()

    sax = [i for i, s in enumerate(stack.slices) if s.view is View.SAX and s.outlines]
    longest, shortest = max(sax, key=sizes.__getitem__), min(sax, key=sizes.__getitem__)
    free = len(sax)
    assert cost(longest, 0.0) == 0.0
    assert cost(longest, 0.05) == pytest.approx(1.0 / free)
    assert cost(longest, 0.1) == pytest.approx(4.0 / free)
    assert cost(shortest, 0.05) > 3.0 * cost(longest, 0.05)


def test_slices_without_outlines_of_what_is_fitted_neither_move_nor_count(
    concentric_spheres,
) -> None:
    """Two slices cannot tell shifts from anatomy; ten without outlines are no help."""
    study = concentric_spheres(endo_mm=9.0, epi_mm=44.0, long_axis=False)
    stack, _ = normalise(build_stack(study, study.frames[0]))
    shown = stack.showing([Structure.LV_ENDO])
    assert sum(bool(s.outlines) for s in shown.slices) == 2
    assert all(a.absent == b.absent for a, b in zip(shown.slices, stack.slices, strict=True))
    shifts = SliceShifts(shown, prior=0.05, limit=0.5)
    with torch.no_grad():
        shifts.in_plane.normal_(0.0, 0.1, generator=torch.Generator().manual_seed(0))
    shifts.restrain()
    np.testing.assert_allclose(shifts.found(), 0.0, atol=1e-6)
