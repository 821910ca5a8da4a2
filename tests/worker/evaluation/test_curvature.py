import igl
import numpy as np
import pytest
import trimesh
from hypothesis import given, settings
from hypothesis import strategies as st
from hypothesis.extra.numpy import arrays
from scipy.spatial.transform import Rotation

from worker.evaluation.curvature import gauss_bonnet_residual, vertex_curvature
from worker.evaluation.size import triangle_areas_mm2
from worker.surface_mesh import SurfaceMesh


def strip(rows: int, columns: int, round_about: bool = False) -> np.ndarray:
    """Faces over a grid of vertices, six at each inner vertex; `round_about` joins its columns."""
    index = np.arange(rows * columns).reshape(rows, columns)
    if round_about:
        index = np.hstack([index, index[:, :1]])
    a, b, c, d = (
        x.ravel() for x in (index[:-1, :-1], index[:-1, 1:], index[1:, 1:], index[1:, :-1])
    )
    return np.vstack([np.stack([a, b, c], 1), np.stack([a, c, d], 1)])


def cylinder(radius_mm: float, height_mm: float, rows: int, columns: int) -> SurfaceMesh:
    """The side of a cylinder about z, open at both ends."""
    z, turn = np.meshgrid(
        np.linspace(0.0, height_mm, rows),
        np.linspace(0.0, 2.0 * np.pi, columns, endpoint=False),
        indexing="ij",
    )
    points = np.stack([radius_mm * np.cos(turn), radius_mm * np.sin(turn), z], axis=-1)
    return SurfaceMesh(points.reshape(-1, 3), strip(rows, columns, round_about=True))


def graph(height, half_mm: float = 10.0, count: int = 41) -> SurfaceMesh:
    """The graph of a height over a square, facing up."""
    along = np.linspace(-half_mm, half_mm, count)
    y, x = np.meshgrid(along, along, indexing="ij")
    points = np.stack([x, y, height(x, y)], axis=-1)
    return SurfaceMesh(points.reshape(-1, 3), strip(count, count))


def fine_torus(major_mm: float, minor_mm: float) -> SurfaceMesh:
    solid = trimesh.creation.torus(major_mm, minor_mm, major_sections=128, minor_sections=64)
    return SurfaceMesh(np.array(solid.vertices), np.array(solid.faces, dtype=np.int64))


ELLIPSOID_MM = np.array([30.0, 25.0, 20.0])
"""Its half axes."""


def curvatures_of_the_ellipsoid(points_mm: np.ndarray) -> tuple[np.ndarray, np.ndarray]:
    """Gaussian and mean, at points on it."""
    steepness = (points_mm**2 / ELLIPSOID_MM**4).sum(axis=1)
    reach = (ELLIPSOID_MM**2).sum() - (points_mm**2).sum(axis=1)
    product = np.prod(ELLIPSOID_MM)
    return 1.0 / (product * steepness) ** 2, reach / (2.0 * product**2 * steepness**1.5)


def reversed_faces(mesh: SurfaceMesh) -> SurfaceMesh:
    return SurfaceMesh(mesh.vertices_mm, mesh.faces[:, ::-1])


def together(*meshes: SurfaceMesh) -> SurfaceMesh:
    starts = np.cumsum([0] + [len(mesh.vertices_mm) for mesh in meshes])
    return SurfaceMesh(
        np.vstack([mesh.vertices_mm for mesh in meshes]),
        np.vstack([mesh.faces + start for mesh, start in zip(meshes, starts, strict=False)]),
    )


def bumpy(mesh: SurfaceMesh) -> SurfaceMesh:
    """The same mesh with vertices out of place, so that triangles of every shape occur."""
    noise = np.random.default_rng(0).normal(scale=0.3, size=mesh.vertices_mm.shape)
    return SurfaceMesh(mesh.vertices_mm + noise, mesh.faces)


def with_flat_triangle(mesh: SurfaceMesh, face: int) -> SurfaceMesh:
    """The middle of an edge becomes a vertex for one of its sides only: between, no area."""
    a, b, c = mesh.faces[face]
    middle = len(mesh.vertices_mm)
    return SurfaceMesh(
        np.vstack([mesh.vertices_mm, (mesh.vertices_mm[a] + mesh.vertices_mm[b]) / 2.0]),
        np.vstack(
            [np.delete(mesh.faces, face, axis=0), [[a, middle, c], [middle, b, c], [a, b, middle]]]
        ),
    )


def with_flat_fan(mesh: SurfaceMesh, face: int) -> SurfaceMesh:
    """A triangle is divided about a new vertex that coincides with one of its corners."""
    a, b, c = mesh.faces[face]
    twin = len(mesh.vertices_mm)
    return SurfaceMesh(
        np.vstack([mesh.vertices_mm, mesh.vertices_mm[a]]),
        np.vstack(
            [np.delete(mesh.faces, face, axis=0), [[a, b, twin], [b, c, twin], [c, a, twin]]]
        ),
    )


def assert_close(values, truth, relative: float):
    """Within a share of the largest true value, everywhere."""
    assert np.abs(values - truth).max() <= relative * np.abs(truth).max()


def test_a_sphere(spheres):
    curvature = vertex_curvature(spheres(20.0, 4))
    assert_close(curvature.gaussian_per_mm2, np.full(2562, 1.0 / 20.0**2), 2e-3)
    assert_close(curvature.mean_per_mm, np.full(2562, 1.0 / 20.0), 1e-5)
    assert not curvature.on_rim.any()


def test_a_sphere_refined_comes_closer(spheres):
    errors = [
        np.abs(vertex_curvature(spheres(20.0, level)).gaussian_per_mm2 * 20.0**2 - 1.0).max()
        for level in (2, 3, 4)
    ]
    # Edges half as long: a quarter of the error.
    assert errors[0] / errors[1] == pytest.approx(4.0, rel=0.1)
    assert errors[1] / errors[2] == pytest.approx(4.0, rel=0.1)


def test_the_side_of_a_cylinder():
    curvature = vertex_curvature(cylinder(10.0, 20.0, rows=21, columns=64))
    inside = ~curvature.on_rim
    assert np.count_nonzero(inside) == 19 * 64
    assert_close(curvature.mean_per_mm[inside], np.full(19 * 64, 1.0 / 20.0), 1e-9)
    np.testing.assert_allclose(curvature.gaussian_per_mm2[inside], 0.0, atol=1e-12)


def test_a_torus():
    mesh = fine_torus(20.0, 5.0)
    curvature = vertex_curvature(mesh)
    # The cosine of the turn within the tube: 1 at the outer equator, -1 at the inner one.
    cosine = (np.hypot(mesh.vertices_mm[:, 0], mesh.vertices_mm[:, 1]) - 20.0) / 5.0
    axis_distance = 20.0 + 5.0 * cosine
    assert_close(curvature.gaussian_per_mm2, cosine / (5.0 * axis_distance), 2e-3)
    assert_close(
        curvature.mean_per_mm, (axis_distance + 5.0 * cosine) / (10.0 * axis_distance), 2e-3
    )
    assert curvature.deficit.sum() == pytest.approx(0.0, abs=1e-9)


def test_the_belt_of_an_ellipsoid():
    belt, turn = np.meshgrid(
        np.linspace(-1.0, 1.0, 81),
        np.linspace(0.0, 2.0 * np.pi, 160, endpoint=False),
        indexing="ij",
    )
    on_ball = np.stack([np.cos(belt) * np.cos(turn), np.cos(belt) * np.sin(turn), np.sin(belt)], -1)
    mesh = SurfaceMesh(on_ball.reshape(-1, 3) * ELLIPSOID_MM, strip(81, 160, round_about=True))
    curvature = vertex_curvature(mesh)
    inside = ~curvature.on_rim
    gaussian, mean = curvatures_of_the_ellipsoid(mesh.vertices_mm[inside])
    assert_close(curvature.gaussian_per_mm2[inside], gaussian, 2e-3)
    assert_close(curvature.mean_per_mm[inside], mean, 2e-3)


def test_a_whole_ellipsoid(spheres):
    """Along the seams of a subdivided icosahedron a few percent stay at any edge length."""
    ball = spheres(1.0, 5)
    mesh = SurfaceMesh(ball.vertices_mm * ELLIPSOID_MM, ball.faces)
    curvature = vertex_curvature(mesh)
    truths = curvatures_of_the_ellipsoid(mesh.vertices_mm)
    for found, truth in zip(
        (curvature.gaussian_per_mm2, curvature.mean_per_mm), truths, strict=True
    ):
        errors = np.abs(found / truth - 1.0)
        assert np.median(errors) < 1e-3
        assert np.percentile(errors, 99.0) < 1e-2
        assert errors.max() < 0.1
        weights = curvature.area_mm2
        assert weights @ found == pytest.approx(weights @ truth, rel=1e-3)


def test_a_saddle():
    mesh = graph(lambda x, y: (x**2 - y**2) / (2.0 * 15.0))
    curvature = vertex_curvature(mesh)
    inside = ~curvature.on_rim
    x, y, _ = mesh.vertices_mm[inside].T
    tilt = 1.0 + (x**2 + y**2) / 15.0**2
    assert (curvature.gaussian_per_mm2[inside] < 0.0).all()
    assert_close(curvature.gaussian_per_mm2[inside], -1.0 / (15.0 * tilt) ** 2, 2e-3)
    # Seen from above it is convex along y and hollow along x.
    mean = (x**2 - y**2) / (2.0 * 15.0**3 * tilt**1.5)
    assert_close(curvature.mean_per_mm[inside], mean, 2e-3)


def test_a_plane_has_no_curvature():
    curvature = vertex_curvature(graph(lambda x, y: 0.3 * x - 0.7 * y))
    inside = ~curvature.on_rim
    np.testing.assert_allclose(curvature.gaussian_per_mm2[inside], 0.0, atol=1e-12)
    np.testing.assert_allclose(curvature.mean_per_mm[inside], 0.0, atol=1e-12)


@given(scale=st.floats(0.01, 100.0))
@settings(deadline=None, max_examples=20)
def test_curvature_falls_with_size(torus, scale):
    mesh = bumpy(torus)
    before = vertex_curvature(mesh)
    after = vertex_curvature(SurfaceMesh(scale * mesh.vertices_mm, mesh.faces))
    assert_close(after.gaussian_per_mm2 * scale**2, before.gaussian_per_mm2, 1e-9)
    assert_close(after.mean_per_mm * scale, before.mean_per_mm, 1e-9)
    assert_close(after.area_mm2 / scale**2, before.area_mm2, 1e-9)


@given(
    turn=arrays(np.float64, 3, elements=st.floats(-np.pi, np.pi)),
    shift=arrays(np.float64, 3, elements=st.floats(-300.0, 300.0)),
)
@settings(deadline=None, max_examples=20)
def test_curvature_does_not_depend_on_the_frame(torus, turn, shift):
    mesh = bumpy(torus)
    before = vertex_curvature(mesh)
    moved = Rotation.from_rotvec(turn).apply(mesh.vertices_mm) + shift
    after = vertex_curvature(SurfaceMesh(moved, mesh.faces))
    assert_close(after.gaussian_per_mm2, before.gaussian_per_mm2, 1e-9)
    assert_close(after.mean_per_mm, before.mean_per_mm, 1e-9)


def test_facing_inward_flips_the_mean_curvature_alone(torus):
    outward, inward = vertex_curvature(torus), vertex_curvature(reversed_faces(torus))
    np.testing.assert_allclose(inward.mean_per_mm, -outward.mean_per_mm, rtol=1e-9)
    np.testing.assert_allclose(
        inward.gaussian_per_mm2, outward.gaussian_per_mm2, rtol=1e-9, atol=1e-12
    )


def test_mean_curvature_is_the_cotangent_laplacian_of_position(sphere):
    mesh = bumpy(sphere)
    curvature = vertex_curvature(mesh)
    laplacian = igl.cotmatrix(mesh.vertices_mm, mesh.faces) @ mesh.vertices_mm
    expected = np.linalg.norm(laplacian, axis=1) / (2.0 * curvature.area_mm2)
    np.testing.assert_allclose(np.abs(curvature.mean_per_mm), expected, rtol=1e-6, atol=1e-9)


@pytest.mark.parametrize(
    ("apex", "shares"),
    [
        pytest.param([1.0, np.sqrt(3.0)], [1 / 3, 1 / 3, 1 / 3], id="equilateral"),
        pytest.param([0.0, 2.0], [1 / 2, 1 / 4, 1 / 4], id="right"),
        pytest.param([-1.0, 2.0], [1 / 2, 1 / 4, 1 / 4], id="obtuse"),
        # The circumcentre is (1, 3/4), so the apex has 5/8 mm2 of 2.
        pytest.param([1.0, 2.0], [11 / 32, 11 / 32, 10 / 32], id="acute"),
    ],
)
def test_shares_of_a_triangle(apex, shares):
    mesh = SurfaceMesh(np.array([[0, 0, 0], [2, 0, 0], [*apex, 0]], float), np.array([[0, 1, 2]]))
    area = triangle_areas_mm2(mesh).sum()
    np.testing.assert_allclose(vertex_curvature(mesh).area_mm2, np.array(shares) * area)


def test_shares_are_positive_and_make_up_the_area(sphere):
    mesh = bumpy(sphere)
    areas = vertex_curvature(mesh).area_mm2
    assert areas.min() > 0.0
    assert areas.sum() == pytest.approx(triangle_areas_mm2(mesh).sum())


def test_a_rim_has_an_angle_deficit_but_no_curvature():
    curvature = vertex_curvature(cylinder(10.0, 20.0, rows=5, columns=64))
    np.testing.assert_array_equal(curvature.on_rim.reshape(5, 64).all(axis=1), [1, 0, 0, 0, 1])
    np.testing.assert_array_equal(np.isnan(curvature.gaussian_per_mm2), curvature.on_rim)
    np.testing.assert_array_equal(np.isnan(curvature.mean_per_mm), curvature.on_rim)
    # Unrolled it is a straight edge.
    np.testing.assert_allclose(curvature.deficit, 0.0, atol=1e-12)
    assert curvature.area_mm2.min() > 0.0


def test_the_corners_of_a_triangle_turn_once():
    mesh = SurfaceMesh(np.array([[0, 0, 0], [2, 0, 0], [0, 2, 0]], float), np.array([[0, 1, 2]]))
    np.testing.assert_allclose(
        vertex_curvature(mesh).deficit, np.array([1 / 2, 3 / 4, 3 / 4]) * np.pi
    )


@pytest.mark.parametrize("place", [0, 642], ids=["first", "last"])
def test_a_vertex_out_of_use_has_no_curvature(spheres, place):
    ball = spheres(20.0, 3)
    vertices = np.insert(ball.vertices_mm, place, 0.0, axis=0)
    curvature = vertex_curvature(SurfaceMesh(vertices, ball.faces + (ball.faces >= place)))
    assert np.flatnonzero(np.isnan(curvature.gaussian_per_mm2)).tolist() == [place]
    assert np.flatnonzero(np.isnan(curvature.mean_per_mm)).tolist() == [place]
    assert curvature.area_mm2[place] == curvature.deficit[place] == 0.0
    assert not curvature.on_rim[place]


def test_no_faces_bend_nowhere():
    nothing = SurfaceMesh(np.zeros((2, 3)), np.zeros((0, 3), dtype=np.int64))
    assert np.isnan(vertex_curvature(nothing).gaussian_per_mm2).all()
    assert gauss_bonnet_residual(nothing) == 0.0


@pytest.mark.parametrize("divided", [with_flat_triangle, with_flat_fan])
def test_triangles_without_area_do_not_bend_a_plane(divided):
    plane = graph(lambda x, y: 0.3 * x - 0.7 * y, count=7)
    mesh = divided(plane, face=14)
    curvature = vertex_curvature(mesh)
    measured = ~np.isnan(curvature.mean_per_mm)
    assert np.count_nonzero(measured) >= 5 * 5
    np.testing.assert_allclose(curvature.mean_per_mm[measured], 0.0, atol=1e-12)
    assert curvature.area_mm2.sum() == pytest.approx(triangle_areas_mm2(mesh).sum())
    assert gauss_bonnet_residual(mesh) == pytest.approx(0.0, abs=1e-9)


def test_a_flat_triangle_leaves_the_rest_of_a_sphere_alone(spheres):
    ball = spheres(20.0, 4)
    divided = with_flat_triangle(ball, face=1000)
    before, after = vertex_curvature(ball), vertex_curvature(divided)
    assert np.isfinite(after.gaussian_per_mm2).all()
    assert np.isfinite(after.mean_per_mm).all()
    far = np.setdiff1d(np.arange(len(ball.vertices_mm)), ball.faces[1000])
    np.testing.assert_allclose(after.gaussian_per_mm2[far], before.gaussian_per_mm2[far], rtol=1e-9)
    np.testing.assert_allclose(after.mean_per_mm[far], before.mean_per_mm[far], rtol=1e-9)


def test_coincident_vertices_leave_the_rest_of_a_sphere_alone(spheres):
    ball = spheres(20.0, 4)
    divided = with_flat_fan(ball, face=1000)
    before, after = vertex_curvature(ball), vertex_curvature(divided)
    twins = [ball.faces[1000, 0], len(ball.vertices_mm)]
    rest = np.setdiff1d(np.arange(len(ball.vertices_mm)), twins)
    assert_close(after.gaussian_per_mm2[rest], before.gaussian_per_mm2[rest], 1e-2)
    assert_close(after.mean_per_mm[rest], before.mean_per_mm[rest], 1e-4)
    # They have one deficit between them.
    assert after.deficit[twins].sum() == pytest.approx(before.deficit[twins[0]])


def test_deficits_of_known_surfaces_add_up(sphere, torus, cube, spheres):
    moved = SurfaceMesh(sphere.vertices_mm + 100.0, sphere.faces)
    for mesh, euler in [
        (sphere, 2),
        (bumpy(sphere), 2),
        (cube, 2),
        (torus, 0),
        (cylinder(10.0, 20.0, rows=5, columns=32), 0),
        (SurfaceMesh(sphere.vertices_mm, sphere.faces[1:]), 1),
        (together(sphere, moved), 4),
    ]:
        assert vertex_curvature(mesh).deficit.sum() == pytest.approx(2.0 * np.pi * euler, abs=1e-9)
        assert gauss_bonnet_residual(mesh) == pytest.approx(0.0, abs=1e-9)


def test_the_corners_of_a_cube_share_its_deficit(cube):
    np.testing.assert_allclose(vertex_curvature(cube).deficit, np.pi / 2.0)


@given(
    vertices=arrays(np.float64, (8, 3), elements=st.integers(-2, 2).map(float)),
    faces=arrays(np.int64, st.tuples(st.integers(0, 12), st.just(3)), elements=st.integers(0, 7)),
)
@settings(deadline=None)
def test_deficits_of_any_triangles_add_up(vertices, faces):
    """Forks, rims that touch, coincident and collinear corners, corners named twice."""
    assert gauss_bonnet_residual(SurfaceMesh(vertices, faces)) == pytest.approx(0.0, abs=1e-9)
