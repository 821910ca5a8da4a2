import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st

from schemas.vocabulary import Axes
from worker.artifacts.page.orientation import orientation

numbers = st.floats(-1.0, 1.0)
HALF_TURN = np.array([-1.0, -1.0, 1.0])


@pytest.mark.parametrize(
    ("normal", "right", "up"),
    [
        ((0.0, 0.0, 1.0), "L", "A"),  # axial, as radiologists look at it: from the feet
        ((0.0, 0.0, -1.0), "L", "A"),
        ((0.0, 1.0, 0.0), "L", "H"),  # coronal, from the front
        ((1.0, 0.0, 0.0), "P", "H"),  # sagittal, from the left
    ],
)
def test_planes_of_the_body(normal: tuple[float, float, float], right: str, up: str) -> None:
    for axes in Axes:
        way = orientation(np.array(normal), axes)
        assert (way.right_letters, way.up_letters) == (right, up)


@given(numbers, numbers, numbers)
def test_directions_are_orthonormal_and_the_left_is_never_on_the_left(
    x: float, y: float, z: float
) -> None:
    normal = np.array([x, y, z])
    length = float(np.linalg.norm(normal))
    if length < 0.1:
        return
    normal /= length
    way = orientation(normal, Axes.LPS)
    frame = np.stack([way.right, way.up, normal])
    np.testing.assert_allclose(frame @ frame.T, np.eye(3), atol=1e-9)
    assert way.right[0] >= -1e-6
    # It matters not which side a slice's normal points to, nor which axes the study has.
    other = orientation(-normal, Axes.LPS)
    np.testing.assert_allclose([other.right, other.up], [way.right, way.up], atol=1e-9)
    ras = orientation(normal * HALF_TURN, Axes.RAS)
    np.testing.assert_allclose([ras.right, ras.up], np.array([way.right, way.up]) * HALF_TURN)
    assert (ras.right_letters, ras.up_letters) == (way.right_letters, way.up_letters)


def test_upward_is_less_in_svg() -> None:
    way = orientation(np.array([0.0, 1.0, 0.0]), Axes.LPS)
    drawn = way.drawn(np.array([[5.0, 0.0, 7.0]]))
    np.testing.assert_allclose(drawn, [[5.0, -7.0]])
