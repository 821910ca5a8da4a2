import numpy as np
import pytest
import trimesh

from schemas.vocabulary import Structure
from worker.evaluation.section import section, section_lines
from worker.evaluation.size import volume_ml
from worker.phantom.analytic_heart import heart
from worker.phantom.outline import enclosed_mm2, perimeter_mm
from worker.surface_mesh import SurfaceMesh

Z = np.array([0.0, 0.0, 1.0])


@pytest.fixture(scope="module")
def torus():
    """About z, finer than elsewhere: an area is measured on every loop."""
    solid = trimesh.creation.torus(20.0, 5.0, major_sections=96, minor_sections=96)
    return SurfaceMesh(np.asarray(solid.vertices), np.asarray(solid.faces, dtype=np.int64))


def signed_area_mm2(loop: np.ndarray, normal: np.ndarray) -> float:
    return float(np.cross(loop, np.roll(loop, -1, axis=0)).sum(axis=0) @ normal / 2.0)


@pytest.mark.parametrize("height", [-4.999, -1.0, 0.0, 3.0, 5.0])
def test_a_cube_is_cut_into_its_square(cube, height):
    (loop,) = section(cube, np.array([0.0, 0.0, height]), Z)
    np.testing.assert_allclose(loop[:, 2], height, atol=1e-12)
    assert perimeter_mm(loop) == pytest.approx(40.0)
    assert signed_area_mm2(loop, Z) == pytest.approx(100.0)


def test_a_plane_through_a_face_is_a_plane_a_hair_below(cube):
    """The top face lies in the plane and belongs to the section; the bottom face does not."""
    assert len(section(cube, np.array([0.0, 0.0, 5.0]), Z)) == 1
    assert section(cube, np.array([0.0, 0.0, -5.0]), Z) == []


@pytest.mark.parametrize("height", [-20.0, -13.0, 0.0, 7.0])
def test_a_sphere_is_cut_into_circles(sphere, height):
    loops = section(sphere, np.array([0.0, 0.0, height]), Z)
    if height == -20.0:
        assert loops == []  # it only touches the plane
        return
    (loop,) = loops
    radius = np.sqrt(400.0 - height**2)
    np.testing.assert_allclose(np.linalg.norm(loop[:, :2], axis=1), radius, rtol=2e-3)
    assert enclosed_mm2(loop) == pytest.approx(np.pi * radius**2, rel=5e-3)


def test_an_oblique_plane_through_the_middle_is_a_great_circle(sphere):
    normal = np.array([1.0, -2.0, 0.5])
    (loop,) = section(sphere, np.zeros(3), normal)
    np.testing.assert_allclose(loop @ normal, 0.0, atol=1e-12)
    assert perimeter_mm(loop) == pytest.approx(2.0 * np.pi * 20.0, rel=2e-3)


def test_the_length_of_the_normal_does_not_matter(sphere):
    (short,) = section(sphere, np.array([1.0, 2.0, 3.0]), 1e-3 * Z)
    (long,) = section(sphere, np.array([1.0, 2.0, 3.0]), 1e3 * Z)
    np.testing.assert_allclose(short, long, atol=1e-9)


def test_a_ring_across_gives_a_hole_of_the_other_direction(torus):
    areas = sorted(signed_area_mm2(loop, Z) for loop in section(torus, np.array([0, 0, 0.01]), Z))
    assert areas[0] == pytest.approx(-np.pi * 15.0**2, rel=5e-3)
    assert areas[1] == pytest.approx(np.pi * 25.0**2, rel=5e-3)


def test_a_ring_along_gives_two_loops_of_one_direction(torus):
    x = np.array([1.0, 0.0, 0.0])
    loops = section(torus, np.zeros(3), x)
    areas = [signed_area_mm2(loop, x) for loop in loops]
    assert areas == pytest.approx([np.pi * 25.0] * 2, rel=5e-3)


def test_turning_the_plane_round_turns_the_loop_round(sphere):
    origin = np.array([0.0, 0.0, 5.1])
    (loop,) = section(sphere, origin, Z)
    (back,) = section(sphere, origin, -Z)
    assert signed_area_mm2(loop, Z) == pytest.approx(-signed_area_mm2(back, Z))


def test_loops_have_as_many_points_as_edges_are_cut(sphere):
    height = sphere.vertices_mm[:, 2] - 3.3
    edges = np.unique(np.sort(sphere.faces[:, [0, 1, 1, 2, 2, 0]].reshape(-1, 2)), axis=0)
    cut = (height[edges] >= 0).sum(axis=1) == 1
    (loop,) = section(sphere, np.array([0.0, 0.0, 3.3]), Z)
    assert len(loop) == cut.sum()


def test_areas_of_sections_add_up_to_the_volume():
    """Cavalieri, on a crescent: the section is right at every height."""
    mesh = heart(0.0).meshes(2.0)[Structure.RV_ENDO]
    normal = np.array([0.3, 0.5, -0.8])
    normal /= np.linalg.norm(normal)
    along = mesh.vertices_mm @ normal
    step = 0.5
    heights = np.arange(along.min() + step / 2, along.max(), step)
    area = sum(
        signed_area_mm2(loop, normal)
        for height in heights
        for loop in section(mesh, height * normal, normal)
    )
    assert area * step / 1000.0 == pytest.approx(volume_ml(mesh), rel=2e-3)


def test_a_plane_beside_the_surface_cuts_nothing(sphere):
    assert section(sphere, np.array([0.0, 0.0, 50.0]), Z) == []


def test_many_planes_through_vertices_always_close(sphere):
    """Planes through three vertices each: every loop is closed, and encloses what it should."""
    generator = np.random.default_rng(0)
    for _ in range(50):
        a, b, c = sphere.vertices_mm[generator.integers(len(sphere.vertices_mm), size=3)]
        normal = np.cross(b - a, c - a)
        if np.linalg.norm(normal) < 1.0:
            continue
        normal /= np.linalg.norm(normal)
        (loop,) = section(sphere, a, normal)
        assert signed_area_mm2(loop, normal) == pytest.approx(
            np.pi * (400.0 - (a @ normal) ** 2), rel=2e-2
        )


def test_the_order_of_faces_does_not_matter(torus):
    shuffled = SurfaceMesh(
        torus.vertices_mm, np.random.default_rng(0).permutation(torus.faces, axis=0)
    )
    origin, normal = np.array([0.0, 0.0, 1.0]), np.array([0.1, 0.2, 1.0])
    lengths = [
        sorted(perimeter_mm(loop) for loop in section(mesh, origin, normal))
        for mesh in (torus, shuffled)
    ]
    assert lengths[0] == pytest.approx(lengths[1])


def test_a_surface_with_a_rim_is_cut_from_rim_to_rim(sphere) -> None:
    """The lower cap of a sphere of 20 mm: an arc upright, a ring across."""
    below = (sphere.triangles_mm[:, :, 2] < 5.0).all(axis=1)
    cup = SurfaceMesh(sphere.vertices_mm, sphere.faces[below])
    origin = np.array([0.0, 0.01, -4.0])
    (arc,) = section_lines(cup, origin, np.array([0.0, 1.0, 0.0]))
    np.testing.assert_allclose(np.linalg.norm(arc, axis=1), 20.0, atol=0.05)
    np.testing.assert_allclose(arc[[0, -1], 2], 5.0, atol=1.5)
    assert np.linalg.norm(arc[0] - arc[-1]) > 35.0
    (ring,) = section_lines(cup, origin, np.array([0.0, 0.0, 1.0]))
    np.testing.assert_array_equal(ring[0], ring[-1])
    (loop,) = section(cup, origin, np.array([0.0, 0.0, 1.0]))
    np.testing.assert_array_equal(loop, ring[:-1])
