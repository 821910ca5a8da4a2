"""Residuals of circles beside a sphere, and where they are counted."""

import numpy as np
import pytest

from schemas.vocabulary import View
from worker.evaluation.residuals import by_thirds, contour_residuals
from worker.evaluation.support import AlignedOutline

UP = np.array([0.0, 0.0, 1.0])


def circle(offset_mm: float, height_mm: float) -> AlignedOutline:
    """`offset_mm` outside a sphere of 20 mm, on a cone about z."""
    angle = np.linspace(0.0, 2.0 * np.pi, 60, endpoint=False)
    polar = np.arccos(height_mm / 20.0)
    out = np.column_stack(
        [np.sin(polar) * np.cos(angle), np.sin(polar) * np.sin(angle), np.full(60, np.cos(polar))]
    )
    return AlignedOutline("sax-00", View.SAX, (20.0 + offset_mm) * out, True)


def test_a_circle_beside_a_sphere_is_as_far_as_it_was_moved(sphere) -> None:
    for one, offset_mm in zip(
        contour_residuals(sphere, [circle(0.0, 3.0), circle(2.0, -15.0)]), (0.0, 2.0), strict=True
    ):
        np.testing.assert_allclose(one.distances_mm, offset_mm, atol=0.02)


def test_thirds_are_those_of_the_surface(sphere) -> None:
    residuals = contour_residuals(sphere, [circle(k, z) for k, z in ((3.0, -15.0), (1.0, 0.0))])
    apex, mid, base = by_thirds(residuals, sphere, UP)
    assert (len(apex), len(mid), len(base)) == (60, 60, 0)
    assert apex.mean() == pytest.approx(3.0, abs=0.02)
    assert mid.mean() == pytest.approx(1.0, abs=0.02)
    turned = by_thirds(residuals, sphere, -UP)
    np.testing.assert_array_equal(turned[2], apex)
    np.testing.assert_array_equal(turned[1], mid)


def test_no_outline_no_residual(sphere) -> None:
    assert contour_residuals(sphere, []) == []
    assert [len(part) for part in by_thirds([], sphere, UP)] == [0, 0, 0]
