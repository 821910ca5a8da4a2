"""Two surfaces on one plane: circles whose distances and overlap have a formula."""

import numpy as np
import pytest
import trimesh
from hypothesis import given, settings
from hypothesis import strategies as st
from scipy.spatial.transform import Rotation

from worker.evaluation.plane_comparison import compare_on_plane, pooled
from worker.surface_mesh import SurfaceMesh

Z = np.array([0.0, 0.0, 1.0])
ORIGIN = np.zeros(3)


def shifted(mesh: SurfaceMesh, by_mm: list[float]) -> SurfaceMesh:
    return SurfaceMesh(mesh.vertices_mm + np.array(by_mm), mesh.faces)


@pytest.mark.parametrize("height_mm", [0.0, 12.0, -16.0])
def test_spheres_about_one_centre(spheres, height_mm: float) -> None:
    """Circles of radii a and b: apart by a - b everywhere, the smaller within the larger."""
    a, b = (np.sqrt(radius**2 - height_mm**2) for radius in (22.0, 20.0))
    found = compare_on_plane(spheres(22.0), spheres(20.0), height_mm * Z, Z)
    np.testing.assert_allclose(found.to_reference_mm, a - b, atol=0.06)
    np.testing.assert_allclose(found.from_reference_mm, a - b, atol=0.06)
    assert found.dice == pytest.approx(2.0 * b**2 / (a**2 + b**2), abs=3e-3)


def test_a_shift_within_the_plane(spheres) -> None:
    """Of a circle by s: distances s |cos| to first order, up to s; the overlap is a lens."""
    ball, shift = spheres(20.0, 6), 1.0
    found = compare_on_plane(shifted(ball, [shift, 0.0, 0.0]), ball, 4.0 * Z, Z)
    for way in (found.to_reference_mm, found.from_reference_mm):
        assert way.max() == pytest.approx(shift, abs=0.01)
        assert way.mean() == pytest.approx(2.0 * shift / np.pi, abs=0.01)
        assert np.sqrt(np.mean(way**2)) == pytest.approx(shift / np.sqrt(2.0), abs=0.01)
    radius = np.sqrt(400.0 - 16.0)
    half = np.arccos(shift / (2.0 * radius))
    lens = (2.0 * half - np.sin(2.0 * half)) * radius**2
    assert found.dice == pytest.approx(lens / (np.pi * radius**2), abs=1e-3)


def test_distances_are_within_the_plane(spheres) -> None:
    """At the height of a polar circle the nearest point of the other sphere is not in the plane."""
    found = compare_on_plane(spheres(21.0), spheres(20.0), 18.0 * Z, Z)
    apart = np.sqrt(21.0**2 - 18.0**2) - np.sqrt(20.0**2 - 18.0**2)
    assert apart > 2.0
    assert found.to_reference_mm.mean() == pytest.approx(apart, abs=0.05)


def test_points_are_spread_by_length_and_not_by_vertices(spheres) -> None:
    """Contours of 50 pi and 40 pi mm have points in that proportion, however finely divided."""
    fine, coarse = spheres(25.0, 6), spheres(20.0, 4)
    found = compare_on_plane(fine, coarse, ORIGIN, Z)
    ratio = len(found.to_reference_mm) / len(found.from_reference_mm)
    assert ratio == pytest.approx(25.0 / 20.0, abs=0.01)


def test_every_loop_of_either_counts(torus, spheres) -> None:
    """The ring has an inner and an outer circle; beside it a disc as wide as the outer one."""
    found = compare_on_plane(torus, spheres(25.0), ORIGIN, Z)
    assert found.to_reference_mm.max() == pytest.approx(10.0, abs=0.1)
    assert found.from_reference_mm.max() < 0.2
    assert found.dice == pytest.approx(2.0 * 400.0 / (400.0 + 625.0), abs=0.01)


def test_disjoint_contours_share_nothing(spheres) -> None:
    found = compare_on_plane(shifted(spheres(5.0), [30.0, 0.0, 0.0]), spheres(5.0), ORIGIN, Z)
    assert found.dice == 0.0
    assert found.to_reference_mm.min() == pytest.approx(20.0, abs=0.05)


@pytest.mark.parametrize("height_mm", [11.0, 30.0])
def test_a_plane_must_cut_both(spheres, height_mm: float) -> None:
    assert compare_on_plane(spheres(20.0), spheres(10.0), height_mm * Z, Z) is None
    assert compare_on_plane(spheres(10.0), spheres(20.0), height_mm * Z, Z) is None


def test_planes_together(spheres) -> None:
    big, small = spheres(22.0), spheres(20.0)
    one, other = (compare_on_plane(big, small, height * Z, Z) for height in (0.0, 12.0))
    both = pooled([one, other])
    assert both.planes == 2
    assert both.dice_mean == pytest.approx((one.dice + other.dice) / 2.0)
    assert both.dice_min == min(one.dice, other.dice)
    every = [way for part in (one, other) for way in (part.to_reference_mm, part.from_reference_mm)]
    assert len(both.distances_mm) == sum(len(way) for way in every)
    assert both.distances_mm.max() == max(way.max() for way in every)


CYLINDER = trimesh.creation.cylinder(10.0, 80.0, sections=48)
TUBE = SurfaceMesh(np.asarray(CYLINDER.vertices, float), np.asarray(CYLINDER.faces, np.int64))
BOX = trimesh.creation.box((14.0, 16.0, 80.0))
BEAM = SurfaceMesh(np.asarray(BOX.vertices, float), np.asarray(BOX.faces, np.int64))


@settings(deadline=None, max_examples=30)
@given(st.floats(-0.5, 0.5), st.floats(-0.5, 0.5), st.floats(-10.0, 10.0))
def test_laws_on_oblique_planes(along_x: float, along_y: float, height_mm: float) -> None:
    """A surface is like itself; which is the reference decides the direction and nothing else; and
    moving everything changes nothing.
    """
    normal, origin = np.array([along_x, along_y, 1.0]), height_mm * Z
    itself = compare_on_plane(TUBE, TUBE, origin, normal)
    assert itself.to_reference_mm.max() < 1e-9
    assert itself.dice == pytest.approx(1.0)
    there, back = (compare_on_plane(*pair, origin, normal) for pair in ((TUBE, BEAM), (BEAM, TUBE)))
    assert 0.0 < there.dice < 1.0
    assert there.dice == pytest.approx(back.dice)
    np.testing.assert_allclose(there.to_reference_mm, back.from_reference_mm, atol=1e-9)
    turn = Rotation.from_euler("xyz", [0.4, -1.1, 2.0]).as_matrix()
    shift = np.array([300.0, -80.0, 9.0])
    moved = [SurfaceMesh(one.vertices_mm @ turn.T + shift, one.faces) for one in (TUBE, BEAM)]
    again = compare_on_plane(*moved, turn @ origin + shift, 3.0 * turn @ normal)
    assert again.dice == pytest.approx(there.dice, abs=1e-9)
    assert again.to_reference_mm.mean() == pytest.approx(there.to_reference_mm.mean(), abs=1e-6)
