"""Nearest points of a square sheet, whose rim is its four sides."""

import numpy as np

from worker.evaluation.nearest_off_rim import NearestOffRim
from worker.surface_mesh import SurfaceMesh

SHEET = SurfaceMesh(
    np.array([[0.0, 0, 0], [10, 0, 0], [10, 10, 0], [0, 10, 0]]), np.array([[0, 1, 2], [0, 2, 3]])
)


def test_a_point_above_is_off_the_rim_and_one_beside_is_on_it() -> None:
    points = np.array([[3.0, 2, 4], [5, 5, 1], [-3, 5, 0], [5, -1, 2], [12, 12, 1]])
    places, normals, off_rim = NearestOffRim(SHEET)(points)
    expected = [[3.0, 2, 0], [5, 5, 0], [0, 5, 0], [5, 0, 0], [10, 10, 0]]
    np.testing.assert_allclose(places, expected, atol=1e-12)
    np.testing.assert_allclose(normals, np.tile([0.0, 0.0, 1.0], (5, 1)))
    # The second lies on the diagonal, an edge but no rim.
    assert off_rim.tolist() == [True, True, False, False, False]


def test_a_closed_surface_has_no_rim(cube) -> None:
    points = np.random.default_rng(0).normal(0.0, 20.0, (200, 3))
    assert NearestOffRim(cube)(points)[2].all()


def test_a_corner_of_the_rim_is_on_it_whichever_triangle_is_nearest() -> None:
    """Of three triangles about a corner of a sheet the middle one has no edge on the rim."""
    corners = np.array([[0.0, 0, 0], [10, 0, 0], [10, 5, 0], [5, 10, 0], [0, 10, 0]])
    fan = SurfaceMesh(corners, np.array([[0, 1, 2], [0, 2, 3], [0, 3, 4]]))
    points = np.array([[-4.0, -4.0, 0.0], [0.0, 0.0, 3.0]])
    for order in np.array([[0, 1, 2], [1, 0, 2], [1, 2, 0]]):
        turned = SurfaceMesh(fan.vertices_mm, fan.faces[order])
        places, _, off_rim = NearestOffRim(turned)(points)
        np.testing.assert_allclose(places, np.zeros((2, 3)), atol=1e-12)
        assert not off_rim.any()
