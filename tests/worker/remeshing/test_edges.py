"""The edges of a closed triangulation, and what is done to them one kind at a time."""

import numpy as np
import pytest
import trimesh

from worker.evaluation.quality import triangle_quality
from worker.evaluation.size import area_cm2
from worker.evaluation.topology import euler_number, is_outward
from worker.observer import Unobserved
from worker.remeshing.decimation import decimate
from worker.remeshing.edge_collapses import collapse_edges
from worker.remeshing.edge_flips import flip_edges
from worker.remeshing.edge_splits import split_edges
from worker.remeshing.edges import edges_of
from worker.remeshing.relaxation import relax
from worker.surface_mesh import SurfaceMesh


@pytest.fixture(scope="module")
def ball() -> SurfaceMesh:
    solid = trimesh.creation.icosphere(subdivisions=3, radius=20.0)
    return SurfaceMesh(np.asarray(solid.vertices), np.asarray(solid.faces, dtype=np.int64))


@pytest.fixture(scope="module")
def box() -> SurfaceMesh:
    solid = trimesh.creation.box((10.0, 10.0, 10.0))
    return SurfaceMesh(np.asarray(solid.vertices), np.asarray(solid.faces, dtype=np.int64))


def test_every_edge_is_there_once_with_its_two_faces(ball: SurfaceMesh) -> None:
    edges = edges_of(ball.faces, len(ball.vertices_mm))
    assert len(edges.keys) == 3 * len(ball.faces) // 2
    assert sorted(np.concatenate([edges.here, edges.there])) == list(range(3 * len(ball.faces)))
    for half_edges, across in ((edges.here, edges.left), (edges.there, edges.right)):
        triples = np.stack([edges.start, edges.end, across], axis=1)
        np.testing.assert_array_equal(
            np.sort(triples, axis=1), np.sort(ball.faces[half_edges // 3], axis=1)
        )


@pytest.mark.parametrize(
    "spoil",
    [lambda faces: faces[1:], lambda faces: np.vstack([faces[:1, ::-1], faces[1:]])],
    ids=["hole", "face turned over"],
)
def test_what_is_not_closed_has_no_such_edges(ball: SurfaceMesh, spoil) -> None:
    with pytest.raises(ValueError, match="not closed"):
        edges_of(spoil(ball.faces), len(ball.vertices_mm))


def test_a_flip_takes_the_shorter_diagonal_of_a_kite() -> None:
    """Two triangles over a long diagonal, closed below by a far point."""
    kite = [[-10.0, 0, 0], [0, -2, 0], [10, 0, 0], [0, 2, 0], [0, 0, -20]]
    faces = np.array([[0, 1, 2], [0, 2, 3], [1, 0, 4], [2, 1, 4], [3, 2, 4], [0, 3, 4]])
    flipped = SurfaceMesh(np.array(kite), flip_edges(np.array(kite), faces))
    assert {frozenset(f) for f in flipped.faces[:2].tolist()} == {
        frozenset({0, 1, 3}),
        frozenset({1, 2, 3}),
    }
    assert is_outward(flipped)


def test_even_triangles_are_not_flipped(ball: SurfaceMesh) -> None:
    np.testing.assert_array_equal(flip_edges(ball.vertices_mm, ball.faces), ball.faces)


@pytest.mark.parametrize("seed", range(4))
def test_any_edges_can_be_split_at_once(box: SurfaceMesh, seed: int) -> None:
    edges = edges_of(box.faces, len(box.vertices_mm))
    chosen = np.random.default_rng(seed).random(len(edges.keys)) < 0.5
    grown = SurfaceMesh(*split_edges(box.vertices_mm, box.faces, edges, chosen))
    assert len(grown.vertices_mm) == len(box.vertices_mm) + chosen.sum()
    assert len(grown.faces) == len(box.faces) + 2 * chosen.sum()
    assert is_outward(grown)
    assert euler_number(grown) == 2
    assert area_cm2(grown) == pytest.approx(area_cm2(box))


def test_collapses_leave_a_closed_surface_and_can_be_repeated(ball: SurfaceMesh) -> None:
    mesh = ball
    for _ in range(60):
        every = np.ones(3 * len(mesh.faces) // 2, dtype=bool)
        mesh = SurfaceMesh(*collapse_edges(mesh.vertices_mm, mesh.faces, every))
        assert is_outward(mesh)
        assert euler_number(mesh) == 2
    assert len(mesh.faces) < len(ball.faces) / 4


def test_an_edge_whose_collapse_would_pinch_the_surface_stays() -> None:
    """Two tetrahedra on one triangle: each of its edges is in a third, empty triangle of edges."""
    vertices = np.array([[1.0, 0, 0], [-0.5, 0.9, 0], [-0.5, -0.9, 0], [0, 0, 5], [0, 0, -5]])
    faces = np.array([[0, 1, 3], [1, 2, 3], [2, 0, 3], [1, 0, 4], [2, 1, 4], [0, 2, 4]])
    edges = edges_of(faces, 5)
    belt = (edges.start < 3) & (edges.end < 3)
    _, left = collapse_edges(vertices, faces, belt)
    assert len(left) == len(faces)


def test_relaxing_evens_a_ball_and_keeps_it_round(ball: SurfaceMesh) -> None:
    noise = np.random.default_rng(1).normal(0.0, 0.4, ball.vertices_mm.shape)
    rough = ball.vertices_mm + noise
    rough *= 20.0 / np.linalg.norm(rough, axis=1, keepdims=True)
    vertices = rough
    for _ in range(5):
        vertices = relax(vertices, ball.faces)
    before, after = (
        triangle_quality(SurfaceMesh(v, ball.faces)).min_angle_mean_deg for v in (rough, vertices)
    )
    assert after > before + 3.0
    np.testing.assert_allclose(np.linalg.norm(vertices, axis=1), 20.0, atol=0.25)


def test_corners_of_a_box_stay_when_the_rest_is_relaxed(box: SurfaceMesh) -> None:
    vertices, faces = box.vertices_mm, box.faces
    for _ in range(4):
        edges = edges_of(faces, len(vertices))
        vertices, faces = split_edges(vertices, faces, edges, np.ones(len(edges.keys), dtype=bool))
    moved = relax(vertices, faces)
    np.testing.assert_allclose(moved[:8], box.vertices_mm)
    assert np.abs(moved).max() == pytest.approx(5.0)


def test_decimation_makes_edges_as_long_as_asked_for(ball: SurfaceMesh) -> None:
    coarse = SurfaceMesh(*decimate(ball.vertices_mm, ball.faces, 6.0, Unobserved()))
    assert is_outward(coarse)
    assert triangle_quality(coarse).edge_mean_mm == pytest.approx(6.0, rel=0.15)


def test_decimation_leaves_what_is_coarse(ball: SurfaceMesh) -> None:
    _, faces = decimate(ball.vertices_mm, ball.faces, 1.0, Unobserved())
    assert len(faces) == len(ball.faces)
