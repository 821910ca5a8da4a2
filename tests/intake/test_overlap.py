"""Areas and shared areas against shapely and closed form."""

import numpy as np
import pytest
import shapely
from numpy.typing import NDArray

from intake.overlap import Overlap, overlap, overlaps

Array = NDArray[np.float64]


def disc(radius: float, x: float = 0.0, flat: float = 1.0) -> Array:
    t = np.linspace(0, 2 * np.pi, 400, endpoint=False)
    return np.c_[x + radius * np.cos(t), flat * radius * np.sin(t)]


def test_area_of_an_ellipse() -> None:
    assert overlap([disc(20, flat=0.5)], ()).area_mm2 == pytest.approx(np.pi * 20 * 10, rel=1e-3)


def test_a_hole_is_no_area() -> None:
    assert overlap([disc(20), disc(10)], ()).area_mm2 == pytest.approx(np.pi * 300, rel=1e-3)


@pytest.mark.parametrize("shift", [0.0, 5.0, 17.0, 39.0, 41.0])
def test_shared_area_agrees_with_shapely(shift: float) -> None:
    one, other = disc(20), disc(20, shift)
    expected = shapely.Polygon(one).intersection(shapely.Polygon(other)).area
    assert overlap([one], [other]).shared_mm2 == pytest.approx(expected, abs=1.5)


def test_shared_and_outside_make_up_the_whole() -> None:
    found = overlap([disc(20)], [disc(15, 12)])
    assert found.shared_mm2 + found.outside_mm2 == pytest.approx(found.area_mm2)
    assert 0 < found.share < 1


def test_within_nothing_is_no_share() -> None:
    assert overlap([disc(20)], []).shared_mm2 == 0.0
    assert Overlap(area_mm2=0.0, shared_mm2=0.0).share == 0.0


def test_a_fill_without_height_has_no_area() -> None:
    flat = np.array([[0.0, 0.0], [10.0, 0.0], [20.0, 0.0]])
    for level in (flat, np.add(flat, (0.0, 5e-324))):
        assert overlap([level], [disc(20)]) == Overlap(0.0, 0.0)


def test_many_pairs_are_measured_as_each_alone() -> None:
    rng = np.random.default_rng(0)
    pairs = [
        ([disc(rng.uniform(5, 30), rng.uniform(-40, 40), rng.uniform(0.1, 1))] * int(n), [disc(20)])
        for n in rng.integers(1, 4, 60)
    ]
    # One outline of many edges, each of which crosses every line.
    comb = np.c_[np.arange(20_000) / 200.0, np.arange(20_000) % 2 * 30.0]
    closed = np.r_[comb, [[100.0, -10.0], [0.0, -10.0]]]
    pairs.append(([closed], [disc(20, 50)]))
    for pair, found in zip(pairs, overlaps(pairs), strict=True):
        alone = overlap(*pair)
        assert found.area_mm2 == pytest.approx(alone.area_mm2)
        assert found.shared_mm2 == pytest.approx(alone.shared_mm2)
    # Teeth fill half of their box.
    assert found.area_mm2 == pytest.approx(100 * (10 + 30 / 2), rel=2e-3)
