"""Even triangles on the same level set, and the surface as closed as before."""

from collections.abc import Callable

import numpy as np
import pytest

from schemas.job import Progress
from schemas.problem import InternalError
from worker.evaluation.distance import surface_to_surface
from worker.evaluation.quality import triangle_quality
from worker.evaluation.topology import euler_number, is_outward, is_watertight
from worker.observer import Cancelled, Unobserved
from worker.reconstruction.isosurface import isosurfaces
from worker.reconstruction.projection import project
from worker.remeshing.remeshing import remesh
from worker.surface_mesh import SurfaceMesh

Shape = Callable[[np.ndarray], np.ndarray]
"""(n, 3) points in mm to (n,) values, positive inside."""


def ball(points: np.ndarray) -> np.ndarray:
    return 20.0 - np.linalg.norm(points, axis=1)


def lens(points: np.ndarray) -> np.ndarray:
    """40 mm across and 8 mm thick, with a rim of 0.8 mm radius."""
    return 4.0 * (1.0 - np.linalg.norm(points / [20.0, 20.0, 4.0], axis=1))


def ring(points: np.ndarray) -> np.ndarray:
    across = np.linalg.norm(points[:, :2], axis=1) - 15.0
    return 5.0 - np.hypot(across, points[:, 2])


def with_gradient(shape: Shape) -> Callable[[np.ndarray], tuple[np.ndarray, np.ndarray]]:
    def values_and_gradients(points: np.ndarray) -> tuple[np.ndarray, np.ndarray]:
        steps = 1e-4 * np.eye(3)
        slopes = [(shape(points + h) - shape(points - h)) / 2e-4 for h in steps]
        return shape(points), np.stack(slopes, axis=1)

    return values_and_gradients


def raw(shape: Shape, cell_mm: float = 1.0) -> SurfaceMesh:
    """Marching cubes, its vertices on the surface: slivers and all."""
    (found,) = isosurfaces(
        lambda points: shape(points)[:, None], np.full(3, -23.3), np.full(3, 23.3), cell_mm
    )
    vertices = project(found.vertices, with_gradient(shape), 3, cell_mm)
    return SurfaceMesh(vertices, found.faces)


def onto(shape: Shape, edge_mm: float) -> Callable[[np.ndarray], np.ndarray]:
    return lambda points: project(points, with_gradient(shape), 1, 0.5 * edge_mm)


def remeshed(shape: Shape, mesh: SurfaceMesh, edge_mm: float) -> SurfaceMesh:
    onto_surface = onto(shape, edge_mm)
    return SurfaceMesh(*remesh(mesh.vertices_mm, mesh.faces, edge_mm, onto_surface, Unobserved()))


@pytest.mark.parametrize("shape", [ball, lens, ring])
@pytest.mark.parametrize("edge_mm", [1.0, 1.5, 2.0, 3.0, 5.0])
def test_triangles_are_even_and_the_surface_is_as_closed_as_before(
    shape: Shape, edge_mm: float
) -> None:
    given = raw(shape)
    even = remeshed(shape, given, edge_mm)
    assert is_outward(even)
    assert euler_number(even) == euler_number(given)
    quality = triangle_quality(even)
    assert quality.below_20_deg_percent == 0.0
    assert quality.min_angle_mean_deg > 45.0
    assert triangle_quality(given).below_20_deg_percent > 5.0


@pytest.mark.parametrize("edge_mm", [1.0, 2.0, 3.0])
def test_edges_are_as_long_as_asked_for_where_the_surface_is_flatter_than_that(
    edge_mm: float,
) -> None:
    quality = triangle_quality(remeshed(ball, raw(ball), edge_mm))
    assert quality.edge_mean_mm == pytest.approx(edge_mm, rel=0.05)
    assert quality.edge_p5_mm > 0.65 * edge_mm
    assert quality.edge_p95_mm < 1.4 * edge_mm


@pytest.mark.parametrize("shape", [ball, lens, ring])
def test_it_stays_on_the_surface(shape: Shape) -> None:
    given = raw(shape, 0.5)
    even = remeshed(shape, given, 2.0)
    # Vertices are on the level set; between them triangles of 2 mm sag.
    values, gradients = with_gradient(shape)(even.vertices_mm)
    assert np.max(np.abs(values) / np.linalg.norm(gradients, axis=1)) < 1e-3
    distance = surface_to_surface(even, given)
    assert distance.mean_mm < 0.05
    assert distance.hausdorff95_mm < 0.1
    assert distance.hausdorff_mm < 0.4


def test_a_sharp_rim_is_kept_by_shorter_edges() -> None:
    even = remeshed(lens, raw(lens), 3.0)
    edge = np.linalg.norm(even.vertices_mm[:, :2], axis=1).max()
    assert edge == pytest.approx(20.0, abs=0.1)


def test_the_same_mesh_comes_out_again() -> None:
    given = raw(lens)
    one, two = (remeshed(lens, given, 2.0) for _ in range(2))
    np.testing.assert_array_equal(one.vertices_mm, two.vertices_mm)
    np.testing.assert_array_equal(one.faces, two.faces)


def test_a_coarse_mesh_is_made_finer() -> None:
    even = remeshed(ball, raw(ball, 6.0), 3.0)
    assert is_watertight(even)
    assert triangle_quality(even).edge_mean_mm == pytest.approx(3.0, rel=0.25)


@pytest.mark.parametrize("edge_mm", [30.0, 1000.0])
def test_an_edge_as_long_as_the_surface_leaves_a_closed_surface(edge_mm: float) -> None:
    even = remeshed(ball, raw(ball), edge_mm)
    assert is_outward(even)
    assert euler_number(even) == 2


def test_a_surface_with_a_hole_is_refused() -> None:
    mesh = raw(ball)
    with pytest.raises(InternalError, match="not closed"):
        remesh(mesh.vertices_mm, mesh.faces[1:], 4.0, onto(ball, 4.0), Unobserved())


class After:
    """Asks to stop after some looks."""

    def __init__(self, looks: int) -> None:
        self.left = looks

    def advanced(self, progress: Progress) -> None:
        raise AssertionError("a part of a stage reports no progress of its own")

    def is_cancelled(self) -> bool:
        self.left -= 1
        return self.left < 0


@pytest.mark.parametrize("looks", [0, 1, 4])
def test_it_stops_when_asked(looks: int) -> None:
    mesh = raw(ball)
    observer = After(looks)
    with pytest.raises(Cancelled):
        remesh(mesh.vertices_mm, mesh.faces, 2.0, onto(ball, 2.0), observer)
    assert observer.left == -1
