"""Overlap of sections with outlines whose areas have a formula."""

import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st
from scipy.spatial.transform import Rotation

from intake.planes import Plane
from schemas.vocabulary import View
from worker.evaluation.plane_overlap import enclosed, plane_dice
from worker.evaluation.section import section
from worker.evaluation.support import AlignedOutline
from worker.surface_mesh import SurfaceMesh

Z = np.array([0.0, 0.0, 1.0])
ORIGIN = np.zeros(3)


def outline(points_mm: np.ndarray, closed: bool) -> AlignedOutline:
    return AlignedOutline("sax-00", View.SAX, points_mm, closed)


def circle(radius_mm: float, centre: tuple[float, float] = (0.0, 0.0), z: float = 0.0):
    angle = np.linspace(0.0, 2.0 * np.pi, 720, endpoint=False)
    x, y = centre
    points = [x + radius_mm * np.cos(angle), y + radius_mm * np.sin(angle), np.full(720, z)]
    return outline(np.column_stack(points), True)


def overlap(mesh, outlines, origin_mm: np.ndarray, normal: np.ndarray) -> float | None:
    """Of a closed mesh's section on a plane."""
    plane = Plane.through(origin_mm, normal)
    return plane_dice(section(mesh, origin_mm, normal), outlines, plane)


def square(side: float, corner: tuple[float, float] = (0.0, 0.0)) -> np.ndarray:
    return np.array(corner) + side * np.array([[0.0, 0.0], [1.0, 0.0], [1.0, 1.0], [0.0, 1.0]])


@pytest.mark.parametrize("height", [0.0, 12.0])
@pytest.mark.parametrize("factor", [0.5, 1.0, 1.5])
def test_circles_about_one_centre(sphere, height: float, factor: float) -> None:
    """Areas a and b, one in the other: 2 min(a, b) / (a + b)."""
    radius_mm = np.sqrt(20.0**2 - height**2)
    outlines = [circle(factor * radius_mm, z=height)]
    expected = 2.0 * min(1.0, factor**2) / (1.0 + factor**2)
    found = overlap(sphere, outlines, np.array([0.0, 0.0, height]), Z)
    assert found == pytest.approx(expected, abs=2e-3)


def test_a_plane_that_misses_one_of_both(sphere) -> None:
    beyond = np.array([0.0, 0.0, 30.0])
    assert overlap(sphere, [circle(5.0, z=30.0)], beyond, Z) == 0.0
    assert overlap(sphere, [], ORIGIN, Z) == 0.0
    assert overlap(sphere, [], beyond, Z) is None


def test_a_hole_in_a_hole(torus) -> None:
    """The torus is cut into a ring from 15 to 25 mm."""
    assert overlap(torus, [circle(25.0), circle(15.0)], ORIGIN, Z) == pytest.approx(1.0, abs=0.01)
    filled = overlap(torus, [circle(25.0)], ORIGIN, Z)
    assert filled == pytest.approx(2.0 * 400.0 / (400.0 + 625.0), abs=0.01)


def test_beyond_the_chord_of_an_open_outline_nothing_is_asked(sphere) -> None:
    """An arc over three quarters of a circle's height is closed by a chord, and so is the cut."""
    angle = np.linspace(np.radians(-210.0), np.radians(30.0), 400)
    arc = 20.0 * np.column_stack([np.cos(angle), np.sin(angle), np.zeros(400)])
    assert overlap(sphere, [outline(arc, False)], ORIGIN, Z) == pytest.approx(1.0, abs=2e-3)
    closed = overlap(sphere, [outline(arc, True)], ORIGIN, Z)
    share = (2.0 / 3.0 * np.pi + np.sin(np.radians(120.0)) / 2.0) / np.pi
    assert closed == pytest.approx(2.0 * share / (1.0 + share), abs=2e-3)


def test_moving_everything_changes_nothing(sphere) -> None:
    turn, shift = (
        Rotation.from_euler("xyz", [0.4, -1.1, 2.0]).as_matrix(),
        np.array([300.0, -80.0, 9]),
    )
    moved = SurfaceMesh(sphere.vertices_mm @ turn.T + shift, sphere.faces)
    given = circle(18.0, (3.0, 1.0), 4.0)
    here = overlap(sphere, [given], np.array([0.0, 0.0, 4.0]), Z)
    there = overlap(
        moved,
        [outline(given.points_mm @ turn.T + shift, True)],
        turn @ np.array([0.0, 0.0, 4.0]) + shift,
        7.0 * turn @ Z,
    )
    assert there == pytest.approx(here, abs=1e-9)


@given(st.floats(0.0, 9.0))
def test_a_square_beside_itself_shares_what_it_still_covers(shift: float) -> None:
    one, other = enclosed([square(10.0)]), enclosed([square(10.0, (shift, 0.0))])
    assert one.intersection(other).area == pytest.approx(100.0 - 10.0 * shift)


def test_a_ring_in_a_ring_is_a_hole_whichever_comes_first() -> None:
    outer, inner = square(10.0), square(5.0, (2.0, 2.0))
    for rings in ([outer, inner], [inner, outer]):
        assert enclosed(rings).area == pytest.approx(75.0)


def test_a_ring_that_crosses_itself_still_has_an_area() -> None:
    bow = np.array([[0.0, 0.0], [2.0, 2.0], [2.0, 0.0], [0.0, 2.0]])
    assert enclosed([bow]).area == pytest.approx(2.0)
    assert enclosed([np.zeros((2, 2))]).area == 0.0


def test_rings_may_have_different_counts_of_points() -> None:
    corners = square(10.0)
    finer = np.concatenate([corners, [corners[-1]]])
    # Of a list the shape check looks at one ring, drawn anew at each call.
    for _ in range(20):
        assert enclosed([corners, finer + 100.0]).area == pytest.approx(200.0)
