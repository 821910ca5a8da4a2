import numpy as np
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st
from hypothesis.extra.numpy import arrays
from scipy.spatial.transform import Rotation

from tests.worker.evaluation.exact_crossings import exact_crossings, exact_self_intersections
from worker.evaluation.triangle_crossings import crossings, self_intersections
from worker.surface_mesh import SurfaceMesh

NOTHING = SurfaceMesh(np.zeros((0, 3)), np.zeros((0, 3), dtype=np.int64))
TILTED = np.array([0.36, 0.48, 0.8])
"""A unit vector along no symmetry of a sphere's mesh."""
FAR_MM = np.array([312.7, -481.3, 795.1])
TURN = Rotation.from_rotvec(1.234 * TILTED)

lattices = st.integers(3, 9).flatmap(
    lambda count: st.builds(
        SurfaceMesh,
        arrays(np.float64, (count, 3), elements=st.integers(0, 4).map(float)),
        st.integers(0, 8).flatmap(
            lambda faces: arrays(np.int64, (faces, 3), elements=st.integers(0, count - 1))
        ),
    )
)
"""Few triangles on few places: corners and edges shared or touching, coplanar, without area."""


def moved(mesh: SurfaceMesh, shift_mm, rotation: Rotation | None = None) -> SurfaceMesh:
    turned = rotation.apply(mesh.vertices_mm) if rotation else mesh.vertices_mm
    return SurfaceMesh(turned + shift_mm, mesh.faces)


def together(one: SurfaceMesh, other: SurfaceMesh) -> SurfaceMesh:
    return SurfaceMesh(
        np.vstack([one.vertices_mm, other.vertices_mm]),
        np.vstack([one.faces, other.faces + len(one.vertices_mm)]),
    )


def soup(*triangles) -> SurfaceMesh:
    corners = np.array(triangles, dtype=float).reshape(-1, 3)
    return SurfaceMesh(corners, np.arange(len(corners)).reshape(-1, 3))


def random_soup(seed: int, count: int) -> SurfaceMesh:
    random = np.random.default_rng(seed)
    middles = random.integers(0, 100, (count, 1, 3))
    return soup(*(middles + random.integers(-25, 26, (count, 3, 3))))


def with_vertex_moved(mesh: SurfaceMesh, vertex: int, factor: float) -> SurfaceMesh:
    vertices = mesh.vertices_mm.copy()
    vertices[vertex] *= factor
    return SurfaceMesh(vertices, mesh.faces)


def figure_of_eight(lift_mm: float) -> SurfaceMesh:
    """Closed tube of 2 mm radius along an eight that crosses itself squarely in the origin; there
    its two strands are lifted apart, one up and one down.
    """
    section, spoke = np.mgrid[0:150, 0:20]
    t, turn = section * 2 * np.pi / 150, spoke[..., None] * 2 * np.pi / 20
    centre = np.stack([20 * np.cos(t), 10 * np.sin(2 * t), lift_mm * np.sin(t)], axis=-1)
    aside = np.stack([-np.cos(2 * t), -np.sin(t), 0 * t], axis=-1)
    aside /= np.linalg.norm(aside, axis=-1, keepdims=True)
    points = centre + 2 * (np.cos(turn) * aside + np.sin(turn) * [0, 0, 1])
    here = section * 20 + spoke
    beside, ahead = np.roll(here, -1, axis=1), np.roll(here, -1, axis=0)
    beyond = np.roll(ahead, -1, axis=1)
    quads = np.stack([here, ahead, beside, beside, ahead, beyond], axis=-1)
    return SurfaceMesh(points.reshape(-1, 3), quads.reshape(-1, 3).astype(np.int64))


def longest_edge_mm(mesh: SurfaceMesh) -> float:
    sides = mesh.triangles_mm - np.roll(mesh.triangles_mm, 1, axis=1)
    return float(np.linalg.norm(sides, axis=2).max())


def test_a_sphere_and_a_torus_do_not_pass_through_themselves(sphere, torus):
    assert self_intersections(sphere).shape == (0, 2)
    assert self_intersections(torus).shape == (0, 2)


def test_concentric_spheres_do_not_cross(spheres):
    assert len(crossings(spheres(20.0, 3), spheres(19.0, 4))) == 0


def test_spheres_apart_do_not_cross(spheres):
    assert len(crossings(spheres(20.0, 3), moved(spheres(20.0, 3), 41 * TILTED))) == 0


def test_overlapping_spheres_cross_all_along_their_common_circle(spheres):
    one = spheres(20.0, 4)
    other = moved(one, 24 * TILTED)
    edge_mm = longest_edge_mm(one)
    pairs = crossings(one, other)

    middles = np.vstack(
        [mesh.triangles_mm[pairs[:, k]].mean(axis=1) for k, mesh in enumerate((one, other))]
    )
    # 12-16-20: the circle of 16 mm radius, 12 mm from either middle.
    along = middles @ TILTED
    across = middles - along[:, None] * TILTED
    from_circle_mm = np.hypot(along - 12, np.linalg.norm(across, axis=1) - 16)
    assert from_circle_mm.max() < edge_mm
    frame = np.linalg.svd(TILTED[None])[2][1:]
    angles = np.sort(np.arctan2(*(across @ frame.T).T))
    gaps = np.diff(angles, append=angles[0] + 2 * np.pi)
    assert 16 * gaps.max() < edge_mm
    assert len(pairs) > 2 * 2 * np.pi * 16 / edge_mm


def test_a_plane_cuts_the_triangles_that_have_corners_on_both_sides(spheres):
    # One triangle hundreds of times as large as the others.
    ball = spheres(20.0, 4)
    height = 7.0
    plane = Rotation.align_vectors(TILTED, [0, 0, 1])[0].apply(
        [[-500, -400, height], [500, -400, height], [0, 600, height]]
    )
    above = ball.triangles_mm @ TILTED > height
    cut = np.flatnonzero(above.any(axis=1) & ~above.all(axis=1))
    assert len(cut) > 50
    assert crossings(ball, soup(plane))[:, 0].tolist() == cut.tolist()
    both = self_intersections(together(ball, soup(plane)))
    assert both.tolist() == [[face, len(ball.faces)] for face in cut]


def test_a_vertex_pushed_through_the_opposite_wall(spheres):
    ball = spheres(20.0, 3)
    vertex = 200
    pairs = self_intersections(with_vertex_moved(ball, vertex, -1.2))
    of_spike = (ball.faces[pairs] == vertex).any(axis=2)
    assert (of_spike.sum(axis=1) == 1).all()
    assert set(pairs[of_spike]) == set(np.flatnonzero((ball.faces == vertex).any(axis=1)))
    pierced = ball.triangles_mm[pairs[~of_spike]].mean(axis=1)
    from_opposite_mm = np.linalg.norm(pierced + ball.vertices_mm[vertex], axis=1)
    assert from_opposite_mm.max() < longest_edge_mm(ball)


@pytest.mark.parametrize("factor", [-0.8, 3.0])
def test_a_spike_that_ends_before_the_wall_is_no_crossing(spheres, factor):
    assert len(self_intersections(with_vertex_moved(spheres(20.0, 3), 200, factor))) == 0


def test_a_tube_along_a_figure_of_eight_passes_through_itself_where_its_strands_meet():
    tube = figure_of_eight(lift_mm=0.0)
    pairs = self_intersections(tube)
    assert len(pairs) > 50
    # Two cylinders that cross squarely meet within root 2 of their radius.
    reach_mm = 2 * np.sqrt(2) + longest_edge_mm(tube)
    assert np.linalg.norm(tube.triangles_mm[pairs].mean(axis=2), axis=-1).max() < reach_mm


def test_strands_that_pass_over_each_other_do_not_cross():
    assert len(self_intersections(figure_of_eight(lift_mm=2.1))) == 0


def test_two_surfaces_cross_each_other_where_their_union_crosses_itself(spheres):
    one, other = spheres(20.0, 3), moved(spheres(15.0, 3), 22 * TILTED)
    pairs = crossings(one, other)
    assert len(pairs) > 20
    pairs[:, 1] += len(one.faces)
    assert np.array_equal(self_intersections(together(one, other)), pairs)


def test_swapping_the_surfaces_swaps_the_pairs(spheres):
    one, other = spheres(20.0, 3), moved(spheres(15.0, 4), 22 * TILTED)
    swapped = crossings(other, one)[:, ::-1]
    assert sorted(swapped.tolist()) == crossings(one, other).tolist()


def test_the_order_of_faces_and_corners_does_not_matter():
    tube = figure_of_eight(lift_mm=0.5)
    order = np.random.default_rng(1).permutation(len(tube.faces))
    shuffled = SurfaceMesh(tube.vertices_mm, np.roll(tube.faces[order], 1, axis=1)[:, ::-1])
    renamed = np.sort(order[self_intersections(shuffled)], axis=1)
    assert sorted(renamed.tolist()) == self_intersections(tube).tolist()


def test_a_rigid_motion_far_from_the_origin_changes_nothing(spheres):
    tube = figure_of_eight(lift_mm=0.5)
    far = self_intersections(moved(tube, FAR_MM, TURN))
    assert np.array_equal(far, self_intersections(tube))
    one, other = spheres(20.0, 3), moved(spheres(15.0, 3), 22 * TILTED)
    far = crossings(moved(one, FAR_MM, TURN), moved(other, FAR_MM, TURN))
    assert np.array_equal(far, crossings(one, other))


def test_random_triangles_agree_with_exact_arithmetic():
    one, other = random_soup(2, 150), random_soup(3, 120)
    assert self_intersections(one).tolist() == (expected := exact_self_intersections(one))
    assert len(expected) > 50
    assert crossings(one, other).tolist() == (expected := exact_crossings(one, other))
    assert len(expected) > 50


@settings(deadline=None, max_examples=200)
@given(lattices)
def test_triangles_that_share_and_touch_agree_with_exact_arithmetic(mesh):
    exact = exact_self_intersections(mesh)
    assert self_intersections(mesh).tolist() == exact
    assert self_intersections(moved(mesh, FAR_MM, TURN)).tolist() == exact


@settings(deadline=None, max_examples=200)
@given(lattices, lattices)
def test_surfaces_that_share_and_touch_agree_with_exact_arithmetic(one, other):
    exact = exact_crossings(one, other)
    assert crossings(one, other).tolist() == exact
    assert crossings(moved(one, FAR_MM, TURN), moved(other, FAR_MM, TURN)).tolist() == exact


def test_a_copy_of_a_surface_touches_it(torus):
    # A torus, because a saddle's neighbours reach to both sides of each other's planes.
    far = moved(torus, FAR_MM, TURN)
    assert len(crossings(far, far)) == 0
    assert len(self_intersections(together(far, far))) == 0


def test_bodies_in_contact_do_not_cross(cube):
    assert len(crossings(cube, moved(cube, [10.0, 3.0, 2.0]))) == 0
    assert len(crossings(cube, moved(cube, [10.0, 10.0, 10.0]))) == 0
    assert len(crossings(cube, moved(cube, [10.0 - 1e-7, 3.0, 2.0]))) == 0
    assert len(crossings(cube, moved(cube, [10.0 - 1e-5, 3.0, 2.0]))) > 0


def test_nothing_is_missed_where_edge_meets_edge():
    # Both cover the same stretch of their common line, from the corner they share to an edge.
    flat = [[-1, -1, 0], [1, -1, 0], [0, 1, 0]]
    upright = [[0, -1, -1], [0, -1, 1], [0, 1, 0]]
    assert crossings(soup(flat), soup(upright)).tolist() == [[0, 0]]


def test_a_flat_fold_is_contact():
    vertices = np.array([[0, 0, 0], [4, 0, 0], [1, 3, 0], [2, 3, 0]], dtype=float)
    folded = SurfaceMesh(vertices, np.array([[0, 1, 2], [1, 0, 3]]))
    assert len(self_intersections(folded)) == 0


@pytest.mark.parametrize("thickness_mm", [0.0, 1e-9])
def test_a_needle_without_an_inside_pierces_nothing(thickness_mm):
    wall = [[-5, -5, 0], [5, -5, 0], [0, 5, 0]]
    needle = [[0, 0, -3], [0.1, 0.1, 3], [0.05 + thickness_mm, 0.05, 0]]
    assert len(crossings(soup(wall), soup(needle))) == 0


def test_triangles_flat_on_one_line_do_not_cross():
    # Rounding leaves them normals in any direction.
    random = np.random.default_rng(0)
    on_line = SurfaceMesh(np.arange(20)[:, None] * TILTED, random.integers(0, 20, (200, 3)))
    assert len(self_intersections(on_line)) == 0
    assert len(self_intersections(moved(on_line, FAR_MM, TURN))) == 0


def test_no_faces_cross_nothing(sphere):
    for pairs in (
        self_intersections(NOTHING),
        crossings(NOTHING, sphere),
        crossings(sphere, NOTHING),
    ):
        assert pairs.shape == (0, 2)
        assert pairs.dtype == np.int64
