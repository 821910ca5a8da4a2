import numpy as np
from hypothesis import given, settings
from hypothesis import strategies as st

from worker.evaluation.topology import (
    boundary_loop_count,
    component_count,
    euler_number,
    is_manifold,
    is_outward,
    is_watertight,
)
from worker.surface_mesh import SurfaceMesh


def beside(first: SurfaceMesh, second: SurfaceMesh) -> SurfaceMesh:
    moved = second.vertices_mm + np.array([100.0, 0.0, 0.0])
    return SurfaceMesh(
        np.vstack([first.vertices_mm, moved]),
        np.vstack([first.faces, second.faces + len(first.vertices_mm)]),
    )


def test_a_sphere_is_closed_outward_and_of_genus_zero(sphere):
    assert is_watertight(sphere)
    assert is_outward(sphere)
    assert euler_number(sphere) == 2
    assert component_count(sphere) == 1
    assert boundary_loop_count(sphere) == 0


def test_a_torus_has_euler_number_zero(torus):
    assert is_outward(torus)
    assert euler_number(torus) == 0


def test_an_inside_out_sphere_is_closed_but_not_outward(sphere):
    inward = SurfaceMesh(sphere.vertices_mm, sphere.faces[:, ::-1])
    assert is_watertight(inward)
    assert not is_outward(inward)


def test_a_missing_triangle_opens_the_surface(sphere):
    holed = SurfaceMesh(sphere.vertices_mm, sphere.faces[1:])
    assert not is_watertight(holed)
    assert boundary_loop_count(holed) == 1
    assert euler_number(holed) == 1


def test_holes_apart_are_counted_apart(cube):
    # The two triangles of opposite sides.
    normals = np.cross(
        cube.triangles_mm[:, 1] - cube.triangles_mm[:, 0],
        cube.triangles_mm[:, 2] - cube.triangles_mm[:, 0],
    )
    tube = SurfaceMesh(cube.vertices_mm, cube.faces[np.abs(normals[:, 2]) < 1.0])
    assert boundary_loop_count(tube) == 2
    assert euler_number(tube) == 0


def test_one_flipped_triangle_is_not_watertight(sphere):
    faces = sphere.faces.copy()
    faces[7] = faces[7, ::-1]
    assert not is_watertight(SurfaceMesh(sphere.vertices_mm, faces))


def test_a_doubled_triangle_is_not_watertight(sphere):
    faces = np.vstack([sphere.faces, sphere.faces[:1]])
    assert not is_watertight(SurfaceMesh(sphere.vertices_mm, faces))


def test_two_spheres_are_two_components(sphere):
    pair = beside(sphere, sphere)
    assert component_count(pair) == 2
    assert euler_number(pair) == 4


def test_vertices_out_of_use_do_not_count(sphere):
    vertices = np.vstack([sphere.vertices_mm, [[0.0, 0.0, 0.0]]])
    with_spare = SurfaceMesh(vertices, sphere.faces)
    assert euler_number(with_spare) == 2
    assert component_count(with_spare) == 1


def test_no_faces_are_no_surface():
    nothing = SurfaceMesh(np.zeros((0, 3)), np.zeros((0, 3), dtype=np.int64))
    assert not is_watertight(nothing)
    assert component_count(nothing) == 0


def test_a_surface_is_manifold_with_or_without_a_rim(cube):
    assert is_manifold(cube)
    assert is_manifold(SurfaceMesh(cube.vertices_mm, cube.faces[1:]))
    spare = SurfaceMesh(np.vstack([cube.vertices_mm, [[0.0, 0.0, 0.0]]]), cube.faces)
    assert is_manifold(spare)


def test_cubes_that_touch_in_a_vertex_or_an_edge_are_not_manifold(cube):
    for step in ([10.0, 10.0, 10.0], [10.0, 10.0, 0.0]):
        both = np.vstack([cube.vertices_mm, cube.vertices_mm + np.array(step)])
        faces = np.vstack([cube.faces, cube.faces + len(cube.vertices_mm)])
        merged, index = np.unique(both, axis=0, return_inverse=True)
        assert not is_manifold(SurfaceMesh(merged, index.reshape(-1)[faces]))


def test_nothing_is_no_manifold(cube):
    assert not is_manifold(SurfaceMesh(cube.vertices_mm, cube.faces[:0]))


soups = st.integers(1, 10).flatmap(
    lambda count: st.lists(
        st.lists(st.integers(0, 7), min_size=3, max_size=3, unique=True),
        min_size=count,
        max_size=count,
    )
)


@settings(deadline=None, max_examples=300)
@given(soups)
def test_what_is_manifold_by_the_neighbours_of_every_vertex(soup):
    """Slowly: about a vertex, its triangles' other sides must make one path or one ring."""
    mesh = SurfaceMesh(np.zeros((8, 3)), np.array(soup, dtype=np.int64))
    across = {v: [sorted(set(f) - {v}) for f in soup if v in f] for f in soup for v in f}
    assert is_manifold(mesh) == all(map(is_path_or_ring, across.values()))


def is_path_or_ring(sides) -> bool:
    ends = [end for side in sides for end in side]
    if max(map(ends.count, ends)) > 2:
        return False
    reached, last = {sides[0][0]}, 0
    while last < len(reached):
        last = len(reached)
        reached |= {end for side in sides if reached & set(side) for end in side}
    return reached == set(ends)
