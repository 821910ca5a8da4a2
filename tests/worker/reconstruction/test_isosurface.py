"""Level sets of formulas: no training needed."""

import numpy as np
import pytest

from worker.evaluation.topology import euler_number, is_watertight
from worker.reconstruction.component import outward, touched_component
from worker.reconstruction.isosurface import isosurfaces
from worker.reconstruction.projection import project
from worker.surface_mesh import SurfaceMesh

LOWER, UPPER = np.full(3, -1.2), np.full(3, 1.2)


def sphere(points: np.ndarray, centre: np.ndarray, radius: float) -> np.ndarray:
    return 20.0 * (radius - np.linalg.norm(points - centre, axis=1))


def torus(points: np.ndarray) -> np.ndarray:
    ring = np.hypot(points[:, 0], points[:, 1]) - 0.7
    return 15.0 * (0.25 - np.hypot(ring, points[:, 2]))


def test_two_surfaces_at_once_are_closed_and_outward() -> None:
    def both(points: np.ndarray) -> np.ndarray:
        return np.column_stack([sphere(points, np.zeros(3), 0.8), torus(points)])

    ball, ring = isosurfaces(both, LOWER, UPPER, 0.05)
    for level_set, chi in ((ball, 2), (ring, 0)):
        mesh = SurfaceMesh(level_set.vertices, level_set.faces)
        assert is_watertight(mesh)
        assert euler_number(mesh) == chi
        np.testing.assert_array_equal(outward(mesh.vertices_mm, mesh.faces), mesh.faces)


def test_the_fine_lattice_is_evaluated_near_the_surface_only() -> None:
    evaluated = 0

    def counted(points: np.ndarray) -> np.ndarray:
        nonlocal evaluated
        evaluated += len(points)
        return sphere(points, np.zeros(3), 0.8)[:, None]

    cell = 0.02
    (ball,) = isosurfaces(counted, LOWER, UPPER, cell)
    assert evaluated < 0.35 * (2.4 / cell) ** 3
    radii = np.linalg.norm(ball.vertices, axis=1)
    assert np.abs(radii - 0.8).max() < 0.02 * cell


def test_a_thin_plate_between_coarse_nodes_is_followed_to_its_end() -> None:
    """A plate thinner than the coarse cells, attached to a ball that they do see."""

    def ball_with_plate(points: np.ndarray) -> np.ndarray:
        plate = np.max(
            np.abs(points - np.array([0.5, 0.0, 0.013])) - np.array([0.5, 0.3, 0.04]), axis=1
        )
        return 20.0 * np.maximum(sphere(points, np.zeros(3), 0.4) / 20.0, -plate)[:, None]

    (found,) = isosurfaces(ball_with_plate, LOWER, UPPER, 0.03)
    assert found.vertices[:, 0].max() == pytest.approx(1.0, abs=0.03)
    assert is_watertight(SurfaceMesh(found.vertices, found.faces))


def test_nothing_positive_gives_no_faces() -> None:
    (nothing,) = isosurfaces(lambda p: -np.ones((len(p), 1)), LOWER, UPPER, 0.2)
    assert len(nothing.faces) == 0


def test_a_surface_at_the_rim_of_the_box_is_closed_there() -> None:
    (capped,) = isosurfaces(lambda p: p[:, :1] * 0.0 + 1.0, LOWER, UPPER, 0.3)
    assert is_watertight(SurfaceMesh(capped.vertices, capped.faces))


def test_the_component_that_contours_touch_is_kept_though_an_island_is_larger() -> None:
    def heart_and_island(points: np.ndarray) -> np.ndarray:
        heart = sphere(points, np.array([-0.6, 0.0, 0.0]), 0.3)
        return np.maximum(heart, sphere(points, np.array([0.5, 0.0, 0.0]), 0.6))[:, None]

    (both,) = isosurfaces(heart_and_island, LOWER, UPPER, 0.05)
    touching = np.array([[-0.9, 0.0, 0.0], [-0.6, 0.3, 0.0], [-0.6, -0.3, 0.0]])
    vertices, faces = touched_component(both.vertices, both.faces, touching)
    assert np.linalg.norm(vertices - [-0.6, 0.0, 0.0], axis=1).max() < 0.31
    assert is_watertight(SurfaceMesh(vertices, faces))
    assert faces.max() == len(vertices) - 1


def test_inside_out_faces_are_turned() -> None:
    (ball,) = isosurfaces(lambda p: sphere(p, np.zeros(3), 0.8)[:, None], LOWER, UPPER, 0.1)
    np.testing.assert_array_equal(outward(ball.vertices, ball.faces[:, ::-1].copy()), ball.faces)


def test_projection_brings_vertices_onto_the_level_set() -> None:
    rng = np.random.default_rng(0)
    directions = rng.standard_normal((500, 3))
    directions /= np.linalg.norm(directions, axis=1, keepdims=True)
    rough = directions * rng.uniform(0.78, 0.82, (500, 1))

    def logits_and_gradient(points: np.ndarray) -> tuple[np.ndarray, np.ndarray]:
        r = np.linalg.norm(points, axis=1, keepdims=True)
        return 8.0 * (0.64 - r[:, 0] ** 2), -16.0 * points

    smooth = project(rough, logits_and_gradient, steps=2, reach=0.05)
    assert np.abs(np.linalg.norm(smooth, axis=1) - 0.8).max() < 1e-6
    np.testing.assert_allclose(np.cross(smooth, rough), 0.0, atol=1e-9)
    leashed = project(rough, logits_and_gradient, steps=2, reach=0.001)
    assert np.linalg.norm(leashed - rough, axis=1).max() <= 0.001 + 1e-12


def test_noise_with_every_ambiguous_cell_is_closed() -> None:
    """White noise on the lattice has every sign pattern; the mesh closes over all of them."""
    noise = np.random.default_rng(0).standard_normal((50, 50, 50))

    def noise_at_nodes(points: np.ndarray) -> np.ndarray:
        nodes = np.clip(np.rint((points - LOWER) / 0.05).astype(int), 0, 49)
        return noise[tuple(nodes.T)][:, None]

    (found,) = isosurfaces(noise_at_nodes, LOWER, UPPER, 0.05)
    assert len(found.faces) > 100_000
    assert is_watertight(SurfaceMesh(found.vertices, found.faces))


def test_a_thin_curved_edge_has_no_handles() -> None:
    """A crescent whose horns thin out to nothing, as a right ventricle's do."""

    def crescent(points: np.ndarray) -> np.ndarray:
        outer = 0.9 - np.linalg.norm(points * [1.0, 1.0, 0.8], axis=1)
        inner = np.linalg.norm((points - [0.35, 0.0, 0.0]) * [1.0, 1.0, 0.8], axis=1) - 0.85
        wobble = 0.01 * np.sin(40.0 * points[:, 2]) * np.cos(31.0 * points[:, 1])
        return 20.0 * (np.minimum(outer, inner) + wobble)[:, None]

    (found,) = isosurfaces(crescent, LOWER, UPPER, 0.04)
    touching = np.array([[-0.9, 0.0, 0.0]])
    vertices, faces = touched_component(found.vertices, found.faces, touching)
    assert euler_number(SurfaceMesh(vertices, faces)) == 2
