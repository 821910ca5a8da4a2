"""Jumps from slice to slice are displacements; what bends smoothly is anatomy."""

from dataclasses import replace

import numpy as np
import pytest

from schemas.vocabulary import Structure, View
from worker.reconstruction.shift_evidence import ShiftEvidence
from worker.reconstruction.stack_smoothness import _area_and_centre, smoothness_evidence
from worker.reconstruction.unit_stack import UnitOutline, UnitSlice, UnitStack

ENDO, EPI, RV = Structure.LV_ENDO, Structure.LV_EPI, Structure.RV_ENDO
UNIT_MM = 50.0
PRIOR, NOISE = 5.0 / UNIT_MM, 0.25 / UNIT_MM
HEIGHTS = np.linspace(-0.9, 0.9, 12)


def ring(radius: float, centre: np.ndarray, turn: float = 0.0) -> UnitOutline:
    t = np.linspace(0.0, 2.0 * np.pi, 40, endpoint=False) + turn
    return UnitOutline(centre + radius * np.column_stack([np.cos(t), np.sin(t)]), True)


def tube(centres_mm: np.ndarray, heights: np.ndarray = HEIGHTS) -> UnitStack:
    """Short-axis slices of a round tube with a wall, whose middle lies at `centres_mm` (n, 2)."""
    slices = []
    for index, (height, centre) in enumerate(zip(heights, centres_mm / UNIT_MM, strict=True)):
        outlines = {ENDO: (ring(0.5, centre),), EPI: (ring(0.7, centre),)}
        origin, axes = np.array([0.0, 0.0, height]), np.eye(3)[:2]
        slices.append(UnitSlice(f"{index}", View.SAX, origin, axes, outlines, frozenset()))
    return UnitStack(tuple(slices))


def evidence_of(stack: UnitStack, *, turning: bool = False) -> ShiftEvidence:
    return smoothness_evidence(stack, PRIOR, NOISE, UNIT_MM, turning=turning)


def in_space_mm(stack: UnitStack, evidence: ShiftEvidence) -> np.ndarray:
    axes = np.array([s.axes for s in stack.slices])
    return UNIT_MM * np.einsum("ka,kad->kd", evidence.motion[:, :2], axes)


def smooth_mm(degree: int) -> np.ndarray:
    return np.column_stack([20.0 * HEIGHTS**degree, 5.0 - 8.0 * HEIGHTS**degree])


def jumps_mm(seed: int = 0, sd_mm: float = 3.0) -> np.ndarray:
    return np.random.default_rng(seed).normal(0.0, sd_mm, (len(HEIGHTS), 2))


def without_smooth(values: np.ndarray) -> np.ndarray:
    """What no polynomial of degree 4 along the stack explains."""
    fitted = np.polynomial.Polynomial.fit
    return np.column_stack([v - fitted(HEIGHTS, v, 4)(HEIGHTS) for v in values.T])


@pytest.mark.parametrize("degree", range(5))
def test_polynomials_are_left_alone(degree: int) -> None:
    evidence = evidence_of(tube(smooth_mm(degree)))
    assert not evidence.displaced
    assert not evidence.motion.any()


@pytest.mark.parametrize("degree", range(5))
def test_polynomials_change_nothing_about_jumps(degree: int) -> None:
    jumps = jumps_mm()
    straight, bent = (evidence_of(tube(jumps + bend)) for bend in (0.0, smooth_mm(degree)))
    np.testing.assert_allclose(bent.motion, straight.motion, atol=1e-12)
    np.testing.assert_allclose(bent.precision, straight.precision)


@pytest.mark.parametrize("seed", range(5))
def test_jumps_are_found_but_for_their_smooth_part(seed: int) -> None:
    given = jumps_mm(seed)
    stack = tube(given)
    evidence = evidence_of(stack)
    assert evidence.displaced
    left, found = without_smooth(given), in_space_mm(stack, evidence)[:, :2]
    assert np.sqrt(((found - left) ** 2).mean()) < 0.15 * np.sqrt((left**2).mean())
    # Two structures that agree, each as sure as its anatomy is steady, against the expectation.
    held, told = evidence.precision[0, 0, 0] / UNIT_MM**2, 0.8**-2 + 0.9**-2
    np.testing.assert_allclose(found, left * told / (told + held), atol=1e-9)
    np.testing.assert_allclose(without_smooth(found), found, atol=1e-9)
    assert not evidence.crossings.any()
    assert np.isnan(evidence.deviations()).all()


def test_how_far_slices_are_displaced_is_what_they_are_expected_to_be() -> None:
    expected_mm = [
        UNIT_MM * evidence_of(tube(jumps_mm(seed))).precision[0, 0, 0] ** -0.5 for seed in range(40)
    ]
    # Of a structure that strays by 0.8 mm where nothing is displaced, and here not at all.
    assert np.sqrt(np.mean(np.square(expected_mm))) == pytest.approx(
        np.sqrt(3.0**2 - 0.8**2), rel=0.08
    )
    evidence = evidence_of(tube(jumps_mm(0, 20.0)))
    np.testing.assert_allclose(
        evidence.precision[:, :2, :2], np.tile(np.eye(2) / PRIOR**2, (12, 1, 1))
    )


@pytest.mark.parametrize("sd_mm", [0.0, 0.2, 0.5])
def test_little_strays_are_anatomy(sd_mm: float) -> None:
    evidence = evidence_of(tube(jumps_mm(1, sd_mm)))
    assert not evidence.displaced
    assert not evidence.motion.any()


def test_shifts_are_along_each_slices_own_axes() -> None:
    given = jumps_mm(2)
    plain = tube(given)
    turned = []
    for index, slice_ in enumerate(plain.slices):
        c, s = np.cos(0.7 * index), np.sin(0.7 * index)
        axes = np.array([[c, s, 0.0], [-s, c, 0.0]]) * [[1.0], [(-1.0) ** index]]
        outlines = {
            structure: tuple(
                UnitOutline(slice_.lift(o.points)[:, :2] @ axes[:, :2].T, o.closed) for o in found
            )
            for structure, found in slice_.outlines.items()
        }
        turned.append(replace(slice_, axes=axes, outlines=outlines))
    stack = UnitStack(tuple(turned))
    np.testing.assert_allclose(
        in_space_mm(stack, evidence_of(stack)), in_space_mm(plain, evidence_of(plain)), atol=1e-9
    )


@pytest.mark.parametrize("count", [0, 1, 2, 3])
def test_few_slices_tell_no_stray_from_a_bend(count: int) -> None:
    evidence = evidence_of(tube(jumps_mm(0, 10.0)[:count], HEIGHTS[:count]))
    assert not evidence.displaced
    assert evidence.motion.shape == (count, 3)


def with_outline(
    stack: UnitStack, index: int, structure: Structure, *more: UnitOutline
) -> UnitStack:
    slices = list(stack.slices)
    own = slices[index].outlines
    outlines = {**own, structure: (*own.get(structure, ()), *more)}
    slices[index] = replace(slices[index], outlines=outlines)
    return UnitStack(tuple(slices))


def test_a_structure_that_few_slices_show_says_nothing() -> None:
    stack = tube(jumps_mm(3))
    more = stack
    for index, x in ((2, 0.9), (5, -0.9), (6, 0.3)):
        more = with_outline(more, index, RV, ring(0.3, np.array([x, 0.0])))
    np.testing.assert_array_equal(evidence_of(more).motion, evidence_of(stack).motion)


def test_the_largest_outline_of_a_slice_is_the_structures() -> None:
    stack = tube(jumps_mm(3))
    more = with_outline(stack, 4, ENDO, ring(0.1, np.array([0.8, 0.8])))
    np.testing.assert_allclose(evidence_of(more).motion, evidence_of(stack).motion, atol=1e-12)


def test_slices_without_outlines_and_long_axis_slices_stay() -> None:
    stack = tube(jumps_mm(3))
    empty = replace(stack.slices[0], id="empty", outlines={})
    side = replace(stack.slices[0], id="side", view=View.LAX_4CH, axes=np.eye(3)[[0, 2]])
    more = UnitStack((empty, *stack.slices, side))
    motion = evidence_of(more).motion
    np.testing.assert_array_equal(motion[[0, -1]], 0.0)
    np.testing.assert_allclose(motion[1:-1], evidence_of(stack).motion, atol=1e-12)


def test_centroids_say_nothing_of_turns() -> None:
    stack = tube(jumps_mm(3))
    held, turning = (evidence_of(stack, turning=t) for t in (False, True))
    assert not turning.motion[:, 2].any()
    assert (turning.precision[:, 2, 2] < 1e-4 * held.precision[:, 2, 2]).all()


def test_the_centre_is_that_of_the_area_not_of_the_points() -> None:
    t = np.concatenate([np.linspace(0.0, np.pi, 400), np.linspace(np.pi, 2.0 * np.pi, 7)[1:-1]])
    half = np.column_stack([np.cos(t[:400]), np.sin(t[:400])])
    area, centre = _area_and_centre(2.0 * half + [3.0, -1.0])
    assert area == pytest.approx(2.0 * np.pi, rel=1e-4)
    np.testing.assert_allclose(centre, [3.0, -1.0 + 8.0 / (3.0 * np.pi)], atol=1e-4)
    same_area, same_centre = _area_and_centre((2.0 * half + [3.0, -1.0])[::-1])
    assert same_area == pytest.approx(area)
    np.testing.assert_allclose(same_centre, centre)


def test_points_in_a_line_enclose_nothing() -> None:
    line = np.column_stack([np.arange(5.0), np.arange(5.0)])
    area, centre = _area_and_centre(line)
    assert area == 0.0
    np.testing.assert_allclose(centre, [2.0, 2.0])
