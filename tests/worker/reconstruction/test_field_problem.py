"""Where slices are after alignment, by two ways that must agree."""

import numpy as np
import pytest

from worker.reconstruction.field_problem import moved_stack, outline_points
from worker.reconstruction.motion import SliceMotion, moved_back
from worker.reconstruction.normalisation import normalise
from worker.reconstruction.stacking import build_stack
from worker.reconstruction.unit_stack import UnitStack


@pytest.fixture(scope="module")
def stack(ellipsoids) -> UnitStack:
    study = ellipsoids()
    return normalise(build_stack(study, study.frames[0]))[0]


def test_a_moved_slice_lifts_its_outlines_to_where_points_are_moved_to(stack: UnitStack) -> None:
    rng = np.random.default_rng(1)
    in_plane = 0.1 * rng.standard_normal((len(stack.slices), 2))
    shifts = np.stack([a @ s.axes for a, s in zip(in_plane, stack.slices, strict=True)])
    pivots = np.stack([s.lift(s.pivot[None])[0] for s in stack.slices])
    motion = SliceMotion(shifts, rng.uniform(-0.3, 0.3, len(stack.slices)), pivots)
    moved = moved_stack(stack, motion)
    for i, (before, after) in enumerate(zip(stack.slices, moved.slices, strict=True)):
        np.testing.assert_allclose(after.axes @ after.axes.T, np.eye(2), atol=1e-12)
        np.testing.assert_allclose(after.normal, before.normal, atol=1e-12)
        for structure, outlines in before.outlines.items():
            for own, other in zip(outlines, after.outlines[structure], strict=True):
                expected = moved_back(
                    before.lift(own.points), shifts[i], motion.turns[i], pivots[i], before.normal
                )
                np.testing.assert_allclose(after.lift(other.points), expected, atol=1e-12)


def test_slices_that_did_not_move_are_where_they_were(stack: UnitStack) -> None:
    count = len(stack.slices)
    still = SliceMotion(np.zeros((count, 3)), np.zeros(count), np.zeros((count, 3)))
    here, there = outline_points(stack), outline_points(moved_stack(stack, still))
    assert here.keys() == there.keys()
    for structure, points in here.items():
        np.testing.assert_allclose(there[structure], points, atol=1e-12)
        assert len(points) == len(stack.showing([structure]).points_unit)
