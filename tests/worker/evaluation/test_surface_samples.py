import numpy as np

from worker.evaluation.surface_samples import area_uniform_samples_mm
from worker.surface_mesh import SurfaceMesh


def test_samples_lie_on_the_surface(cube):
    points = area_uniform_samples_mm(cube, 2000, np.random.default_rng(0))
    assert points.shape == (2000, 3)
    np.testing.assert_allclose(np.abs(points).max(axis=1), 5.0, atol=1e-12)


def test_dense_triangles_weigh_no_more(cube):
    # One side split into many triangles must still get a sixth of the samples.
    corner, rest = cube.faces[:1], cube.faces[1:]
    vertices, faces = list(cube.vertices_mm), []
    a, b, c = corner[0]
    for fraction in np.linspace(0.0, 1.0, 101)[1:-1]:
        vertices.append(vertices[b] * (1 - fraction) + vertices[c] * fraction)
    rim = [b, *range(8, len(vertices)), c]
    faces = [[a, rim[i], rim[i + 1]] for i in range(len(rim) - 1)]
    fan = SurfaceMesh(np.array(vertices), np.vstack([rest, np.array(faces)]))
    points = area_uniform_samples_mm(fan, 60_000, np.random.default_rng(1))
    axis, side = (
        np.abs(points).argmax(axis=1),
        np.sign(points[np.arange(60_000), np.abs(points).argmax(axis=1)]),
    )
    counts = np.array([np.sum((axis == i) & (side == s)) for i in range(3) for s in (-1, 1)])
    np.testing.assert_allclose(counts, 10_000, rtol=0.04)


def test_samples_fill_a_triangle_evenly():
    triangle = SurfaceMesh(np.array([[0.0, 0, 0], [1, 0, 0], [0, 1, 0]]), np.array([[0, 1, 2]]))
    points = area_uniform_samples_mm(triangle, 100_000, np.random.default_rng(2))
    np.testing.assert_allclose(points.mean(axis=0), [1 / 3, 1 / 3, 0.0], atol=3e-3)
    # A quarter of the area lies in x + y < 1/2.
    assert abs(np.mean(points.sum(axis=1) < 0.5) - 0.25) < 0.005
