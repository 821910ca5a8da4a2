"""Long-axis views: by the side of the right ventricle, and none where it is not sure."""

import numpy as np
import pytest

from intake.formats.long_axis_views import long_axis_view, towards_right
from schemas.vocabulary import Structure, View

S = Structure
BOTH = frozenset((S.LV_ENDO, S.RV_ENDO))
LEFT = frozenset((S.LV_EPI,))
NORMAL = np.array([0.0, 0, 1])
RIGHT = np.array([1.0, 0, 0])


def plane(degrees: float, tilt: float = 0.0) -> np.ndarray:
    """Normal of a plane that crosses the short axis along a line `degrees` off the right side."""
    a, t = np.radians(degrees), np.radians(tilt)
    return np.array([-np.sin(a) * np.cos(t), np.cos(a) * np.cos(t), np.sin(t)])


@pytest.mark.parametrize(
    ("degrees", "outlined", "view"),
    [
        *((d, BOTH, View.LAX_4CH) for d in (0, 17.3, 19.1, 24)),
        *((d, BOTH, View.LAX_3CH) for d in (39.9, 42.6, 50)),
        *((d, LEFT, View.LAX_2CH) for d in (70.4, 77.3, 90)),
        *((d, BOTH, View.OTHER) for d in (29, 60, 75.4, 90)),
        *((d, LEFT, View.OTHER) for d in (17, 40, 55)),
        (17, frozenset((S.RV_ENDO,)), View.OTHER),
    ],
)
def test_views(degrees: float, outlined: frozenset[Structure], view: View) -> None:
    """Those of tenths of degrees are of two subjects whose views are known."""
    for sign in (1, -1):
        for angle in (degrees, -degrees, 180 - degrees):
            for tilt in (0, 7):
                normal = sign * plane(angle, tilt)
                assert long_axis_view(normal, outlined, NORMAL, RIGHT) is view


def test_a_plane_that_is_not_across_the_stack_is_of_no_view() -> None:
    assert long_axis_view(plane(0, 30), BOTH, NORMAL, RIGHT) is View.OTHER
    assert long_axis_view(NORMAL, BOTH, NORMAL, RIGHT) is View.OTHER


def test_the_right_side() -> None:
    left, right = np.zeros((4, 3)), np.full((4, 3), [-30.0, 0, 12])
    direction = towards_right([left], [right, right], NORMAL)
    np.testing.assert_allclose(direction, [-1, 0, 0])
    assert towards_right([left], [], NORMAL) is None
    assert towards_right([left], [left + 1], NORMAL) is None
