import numpy as np

from worker.reconstruction.unfolding import unfolded


def grid(n: int) -> tuple[np.ndarray, np.ndarray]:
    """A square of n by n unit cells in the plane z = 0, two triangles each, facing up."""
    x, y = np.meshgrid(np.arange(n + 1.0), np.arange(n + 1.0), indexing="ij")
    vertices = np.column_stack([x.ravel(), y.ravel(), np.zeros(x.size)])
    at = np.arange((n + 1) ** 2).reshape(n + 1, n + 1)
    a, b, c, d = at[:-1, :-1], at[1:, :-1], at[1:, 1:], at[:-1, 1:]
    faces = np.concatenate(
        [np.stack([a, b, c], -1).reshape(-1, 3), np.stack([a, c, d], -1).reshape(-1, 3)]
    )
    return vertices, faces


def test_a_vertex_drawn_past_its_neighbour_comes_back() -> None:
    before, faces = grid(6)
    after = before.copy()
    after[24] += [1.6, 0.0, 0.0]
    np.testing.assert_array_equal(unfolded(before, after, faces), before)


def test_what_did_not_turn_stays_moved() -> None:
    before, faces = grid(6)
    after = before + np.array([0.0, 0.0, 0.4])
    after[24] += [0.3, 0.2, 0.1]
    np.testing.assert_array_equal(unfolded(before, after, faces), after)


def test_only_the_corners_of_turned_triangles_come_back() -> None:
    before, faces = grid(6)
    after = before + np.array([0.0, 0.0, 0.05])
    after[24] += [1.6, 0.0, 0.0]
    found = unfolded(before, after, faces)
    back = (found == before).all(axis=1)
    assert back[24]
    assert not back[[0, 6, 42, 48]].any()
    np.testing.assert_array_equal(found[~back], after[~back])
