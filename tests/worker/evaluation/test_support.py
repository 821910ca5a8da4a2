"""Distances to contours in closed form."""

import numpy as np
import pytest

from schemas.problem import InternalError
from schemas.vocabulary import View
from worker.evaluation.support import (
    AlignedOutline,
    area_beyond_percent,
    distance_to_outlines_mm,
)
from worker.surface_mesh import SurfaceMesh


def outline(*points_mm: tuple[float, float, float], closed: bool = True) -> AlignedOutline:
    return AlignedOutline("sax-00", View.SAX, np.array(points_mm, dtype=float), closed)


def test_distance_is_to_segments_not_to_points() -> None:
    square = outline((0, 0, 0), (10, 0, 0), (10, 10, 0), (0, 10, 0))
    points_mm = np.array([[5.0, 0, 0], [5, -2, 0], [5, 5, 12], [13, 14, 0], [0.0, 4.0, 3.0]])
    found = distance_to_outlines_mm(points_mm, [square])
    np.testing.assert_allclose(found, [0.0, 2.0, 13.0, 5.0, 3.0], atol=1e-12)


def test_the_chord_of_an_open_outline_is_no_evidence() -> None:
    corners = ((0, 0, 0), (10, 0, 0), (10, 10, 0), (0, 10, 0))
    on_chord = np.array([[0.0, 5.0, 0.0]])
    assert distance_to_outlines_mm(on_chord, [outline(*corners)]) == pytest.approx([0.0])
    opened = outline(*corners, closed=False)
    assert distance_to_outlines_mm(on_chord, [opened]) == pytest.approx([5.0])


def test_the_nearest_of_many_outlines_counts() -> None:
    low = outline((0, 0, 0), (10, 0, 0), (0, 10, 0))
    high = outline((0, 0, 8), (10, 0, 8), (0, 10, 8), closed=False)
    found = distance_to_outlines_mm(np.array([[5.0, 0, 3], [5, 0, 6]]), [low, high])
    np.testing.assert_allclose(found, [3.0, 2.0])


def test_the_pole_of_a_sphere_is_as_far_as_its_nearest_ring(sphere: SurfaceMesh) -> None:
    turn = np.linspace(0.0, 2 * np.pi, 720, endpoint=False)
    rings = []
    for z_mm in (-8.0, 0.0, 8.0):
        radius_mm = np.sqrt(400.0 - z_mm**2)
        ring = [radius_mm * np.cos(turn), radius_mm * np.sin(turn), np.full_like(turn, z_mm)]
        rings.append(AlignedOutline(f"{z_mm}", View.SAX, np.stack(ring, axis=1), True))
    support_mm = distance_to_outlines_mm(sphere.vertices_mm, rings)
    # On a meridian: chord between the polar angles of a vertex and of its nearest ring.
    polar = np.arccos(sphere.vertices_mm[:, 2] / 20.0)
    of_rings = np.arccos(np.array([-8.0, 0.0, 8.0]) / 20.0)
    nearest = np.abs(polar[:, None] - of_rings).min(axis=1)
    np.testing.assert_allclose(support_mm, 40.0 * np.sin(nearest / 2), atol=2e-3)
    assert support_mm.max() == pytest.approx(np.hypot(np.sqrt(400 - 64), 12.0), abs=2e-3)


def test_area_beyond_counts_area_and_not_vertices(sphere: SurfaceMesh) -> None:
    height_mm = sphere.vertices_mm[:, 2]
    # The area of a zone of a sphere is in proportion to its height (Archimedes).
    assert area_beyond_percent(sphere, height_mm + 20.0, 30.0) == pytest.approx(25.0, abs=0.5)
    assert area_beyond_percent(sphere, height_mm + 20.0, 40.1) == 0.0


def test_nothing_observed_is_no_distance() -> None:
    with pytest.raises(InternalError, match="No outlines"):
        distance_to_outlines_mm(np.zeros((1, 3)), [])
