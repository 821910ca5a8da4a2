import numpy as np
import pytest
import trimesh
from shapely import LineString, Point

from worker.artifacts.page.thinned_line import thinned_line

TURN = trimesh.transformations.rotation_matrix(1.1, [1.0, -2.0, 0.5])[:3, :3]


def circle(count: int = 200, radius_mm: float = 30.0) -> np.ndarray:
    angles = np.linspace(0.0, 2.0 * np.pi, count)
    flat = np.column_stack([np.cos(angles), np.sin(angles), np.zeros(count)]) * radius_mm
    return flat @ TURN.T + [10.0, -80.0, 300.0]


def test_few_points_are_left_and_all_others_are_near() -> None:
    line = circle()
    thin = thinned_line(line)
    assert len(thin) < 70
    back = (thin - [10.0, -80.0, 300.0]) @ TURN
    drawn = LineString(back[:, :2])
    for point in (line - [10.0, -80.0, 300.0]) @ TURN:
        assert drawn.distance(Point(point[:2])) <= 0.1 + 1e-9
    np.testing.assert_allclose(back[:, 2], 0.0, atol=1e-9)


def test_what_is_left_was_there_and_the_ends_stay() -> None:
    line = circle()[:150]
    thin = thinned_line(line)
    np.testing.assert_allclose(thin[[0, -1]], line[[0, -1]], atol=1e-9)
    gaps = np.linalg.norm(thin[:, None] - line[None], axis=2).min(axis=1)
    assert gaps.max() < 1e-9


@pytest.mark.parametrize("count", [1, 2])
def test_what_is_no_more_than_a_piece_stays(count: int) -> None:
    line = circle()[:count]
    assert np.array_equal(thinned_line(line), line)
