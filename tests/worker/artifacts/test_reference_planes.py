"""Planes by kind of view, two spheres on them."""

import numpy as np
import pytest
import trimesh

from schemas.vocabulary import View
from worker.artifacts.reference_planes import planes_by_view
from worker.observer import Cancelled, Unobserved
from worker.surface_mesh import SurfaceMesh

Z, X = np.array([0.0, 0.0, 1.0]), np.array([1.0, 0.0, 0.0])


def ball(radius_mm: float) -> SurfaceMesh:
    solid = trimesh.creation.icosphere(subdivisions=4, radius=radius_mm)
    return SurfaceMesh(np.asarray(solid.vertices), np.asarray(solid.faces, dtype=np.int64))


BIG, SMALL = ball(22.0), ball(20.0)


def test_kinds_of_view_are_kept_apart_and_empty_ones_left_out() -> None:
    planes = [
        (View.SAX, np.zeros(3), Z),
        (View.SAX, 12.0 * Z, Z),
        (View.SAX, 21.0 * Z, Z),  # cuts only one
        (View.LAX_3CH, np.zeros(3), X),
        (View.OTHER, 30.0 * X, X),  # cuts neither
    ]
    found = planes_by_view(BIG, SMALL, planes, Unobserved())
    assert {kind: part.planes for kind, part in found.items()} == {"short_axis": 2, "long_axis": 1}
    assert found["long_axis"].distance_mm.mean == pytest.approx(2.0, abs=0.05)
    apart = np.sqrt(22.0**2 - 12.0**2) - 16.0
    assert found["short_axis"].distance_mm.max == pytest.approx(apart, abs=0.1)
    assert found["long_axis"].dice_min == found["long_axis"].dice_mean
    assert found["short_axis"].dice_min < found["short_axis"].dice_mean


def test_without_planes_there_is_nothing() -> None:
    assert planes_by_view(BIG, SMALL, [], Unobserved()) == {}


class _Impatient(Unobserved):
    def is_cancelled(self) -> bool:
        return True


def test_it_can_be_stopped() -> None:
    with pytest.raises(Cancelled):
        planes_by_view(BIG, SMALL, [(View.SAX, np.zeros(3), Z)], _Impatient())
