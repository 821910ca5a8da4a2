"""What the radial basis functions are told, piece by piece."""

import numpy as np
import pytest

from tests.worker.interpolation.stacks import (
    CENTRE_MM,
    STRUCTURE,
    TURN,
    cylinder,
    ellipsoid,
    heights_mm,
)
from worker.interpolation.contour_samples import contour_samples
from worker.interpolation.disagreement import disagreement_mm
from worker.interpolation.far_points import far_points
from worker.interpolation.known_sides import known_sides
from worker.interpolation.outline_points import at_fractions, evenly_along
from worker.interpolation.rbf_constraints import Constraints, beside_outlines
from worker.interpolation.stack_ends import beyond_ends


@pytest.mark.parametrize("closed", [True, False])
def test_points_are_even_along_an_outline_and_on_it(closed: bool) -> None:
    square = np.array([[0.0, 0.0], [10.0, 0.0], [10.0, 10.0], [0.0, 10.0]])
    points = evenly_along(square, 1.0, closed=closed)
    assert len(points) == (40 if closed else 30)
    on_an_edge = np.isin(points.round(9), (0.0, 10.0)).any(axis=1)
    assert on_an_edge.all()
    ends = at_fractions(square, 5, closed=closed)[[0, -1]]
    np.testing.assert_allclose(ends, [[0.0, 0.0], [0.0, 8.0] if closed else [0.0, 10.0]])


def test_normals_point_outward_in_the_slice() -> None:
    samples = contour_samples(cylinder(), STRUCTURE, 3.0, 0.5)
    axis = TURN[:, 2]
    radial = samples.points_mm - CENTRE_MM
    radial -= np.outer(radial @ axis, axis)
    np.testing.assert_allclose(samples.normals, radial / 20.0, atol=0.03)
    np.testing.assert_allclose(samples.outer_mm, 0.5)
    np.testing.assert_allclose(samples.inner_mm, 0.5)
    assert samples.short_axis.all()


def test_a_narrow_place_has_nearer_points_or_none() -> None:
    """Within a radius of 20 mm, 30 mm inward is past the middle, nearer to the other side."""
    samples = contour_samples(cylinder(), STRUCTURE, 3.0, 30.0)
    np.testing.assert_allclose(samples.inner_mm, 15.0)
    np.testing.assert_allclose(samples.outer_mm, 30.0)
    assert np.isnan(contour_samples(cylinder(), STRUCTURE, 3.0, 120.0).inner_mm).all()


def test_the_lean_of_a_sphere_from_its_slices() -> None:
    """The gradient of a distance from the centre is the direction from the centre."""
    truth = ellipsoid()
    samples = contour_samples(truth.stack, STRUCTURE, 3.0, 0.5)

    def field(points_mm: np.ndarray) -> np.ndarray:
        return -truth.off_mm(points_mm)

    cosines = samples.cosines(field)
    q = (samples.points_mm - CENTRE_MM) @ TURN / np.array(truth.semi_axes_mm) ** 2
    normals = (q / np.linalg.norm(q, axis=1, keepdims=True)) @ TURN.T
    wanted = np.einsum("nk,nk->n", normals, samples.normals)
    np.testing.assert_allclose(cosines, np.maximum(wanted, 0.25), atol=0.02)


def test_values_beside_outlines_are_distances_to_a_leaning_surface() -> None:
    samples = contour_samples(cylinder(), STRUCTURE, 3.0, 0.5)
    n = len(samples.points_mm)
    told = beside_outlines(samples, np.full(n, 0.6), 1.0, 9.0)
    np.testing.assert_allclose(np.unique(told.values_mm.round(9)), [-0.3, 0.0, 0.3])
    np.testing.assert_allclose(told.smoothing, 10.0)


def test_a_field_is_what_it_was_told_and_a_place_told_twice_counts_once() -> None:
    points = np.random.default_rng(0).uniform(-10.0, 10.0, (40, 3)) + 500.0
    told = Constraints.exact(points, points[:, 0] - 500.0, 0.0)
    again = Constraints.exact(points[:5], np.full(5, 99.0), 0.0)
    field = (told + again).solved(points.mean(axis=0))
    np.testing.assert_allclose(field(points), told.values_mm, atol=1e-6)


def test_aligned_slices_agree_and_displaced_ones_do_not() -> None:
    assert disagreement_mm(ellipsoid().stack, STRUCTURE) <= 0.1
    displaced = ellipsoid(shifts_mm=(3.0,) * 10).stack
    # Across the displacement the outlines meet again: it shows on one of two long axes.
    assert disagreement_mm(displaced, STRUCTURE) == pytest.approx(3.0 / np.sqrt(2.0), rel=0.1)
    assert disagreement_mm(ellipsoid(long_axis=False).stack, STRUCTURE) == 0.0


def test_known_sides_are_those_of_the_shape() -> None:
    truth = ellipsoid()
    points, signed = known_sides(truth.stack, STRUCTURE, 4.0)
    off = truth.off_mm(points)
    clear = np.abs(signed) > 0.5
    assert (np.sign(signed) == -np.sign(off))[clear].all()


def test_an_empty_slice_is_outside_everywhere_and_a_chord_says_nothing() -> None:
    points, signed = known_sides(cylinder(absent=(40.0,)), STRUCTURE, 4.0)
    assert (signed[heights_mm(points) > 36.0] < 0.0).all()
    points, signed = known_sides(ellipsoid(open_above_mm=12.0).stack, STRUCTURE, 4.0)
    on_long_axis = np.abs(heights_mm(points) % 8.0 - 4.0) > 1e-6
    middle = np.abs((points - CENTRE_MM) @ TURN[:, 0]) < 5.0
    middle &= np.abs((points - CENTRE_MM) @ TURN[:, 1]) < 5.0
    assert not (on_long_axis & middle & (heights_mm(points) > 12.0)).any()


@pytest.mark.parametrize(("absent", "at"), [((), (-8.0, 40.0)), ((-3.0,), (-3.0, 40.0))])
def test_a_bare_stack_ends(absent: tuple[float, ...], at: tuple[float, float]) -> None:
    points, signed = beyond_ends(cylinder(absent=absent), STRUCTURE)
    np.testing.assert_allclose(np.unique(heights_mm(points).round(6)), at)
    assert (signed < 0.0).all()


def test_closed_long_axis_outlines_show_the_ends_and_open_ones_end_at_their_chord() -> None:
    assert len(beyond_ends(ellipsoid().stack, STRUCTURE)[0]) == 0
    points, signed = beyond_ends(ellipsoid(open_above_mm=12.0).stack, STRUCTURE)
    assert (heights_mm(points) > 12.0).all()
    np.testing.assert_allclose(signed, -4.0)


def test_far_points_surround_the_hull() -> None:
    points = np.random.default_rng(0).normal(scale=10.0, size=(200, 3))
    far, values = far_points(points, 15.0, 300)
    assert far.shape == (300, 3)
    assert (np.linalg.norm(far - points.mean(axis=0), axis=1) > 20.0).all()
    assert (values < -5.0).all()
    directions = far / np.linalg.norm(far, axis=1, keepdims=True)
    assert np.linalg.norm(directions.mean(axis=0)) < 0.1
