"""Planes are one when they coincide where the heart is."""

import numpy as np
import pytest

from intake.coincidence import coincident, count_distinct
from intake.planes import Plane

CENTRE = np.array([10.0, -20.0, 30.0])
EXTENT = 100.0


def plane(shift: float = 0.0, tilt_degrees: float = 0.0, flip: float = 1.0) -> Plane:
    tilt = np.deg2rad(tilt_degrees)
    normal = np.array([np.sin(tilt), 0.0, np.cos(tilt)])
    return Plane.through(CENTRE + shift * normal, flip * normal)


@pytest.mark.parametrize(
    ("other", "same"),
    [
        (plane(), True),
        (plane(flip=-7.0), True),
        (plane(shift=0.2), True),
        (plane(shift=-0.2, flip=-1.0), True),
        (plane(shift=0.3), False),
        (plane(tilt_degrees=0.5), True),
        (plane(tilt_degrees=1.5), False),
        (plane(tilt_degrees=90.0), False),
    ],
)
def test_tolerances(other: Plane, same: bool) -> None:
    found = coincident([plane(), other], CENTRE, EXTENT)
    np.testing.assert_array_equal(found, [[True, same], [same, True]])


def test_where_an_origin_is_on_its_plane_does_not_matter() -> None:
    far = Plane.through(np.add(CENTRE, (5000.0, -7000.0, 0.0)), np.array([0.0, 0.0, 1.0]))
    assert coincident([plane(), far], CENTRE, EXTENT).all()


def test_units_do_not_matter() -> None:
    planes = [plane(), plane(shift=0.2), plane(shift=5.0)]
    scaled = [Plane.through(1e-3 * p.origin, p.normal) for p in planes]
    np.testing.assert_array_equal(
        coincident(planes, CENTRE, EXTENT), coincident(scaled, 1e-3 * CENTRE, 1e-3 * EXTENT)
    )


@pytest.mark.parametrize("copies", [1, 3])
@pytest.mark.parametrize("apart", [0, 1, 7])
def test_copies_count_once(copies: int, apart: int) -> None:
    planes = [plane(shift=8.0 * k) for k in range(apart) for _ in range(copies)]
    if planes:
        assert count_distinct(coincident(planes, CENTRE, EXTENT)) == apart
    else:
        assert count_distinct(np.empty((0, 0), dtype=np.bool_)) == 0
