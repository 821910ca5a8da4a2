"""Segments lie where the standard picture of the left ventricle has them."""

import numpy as np
import pytest
from scipy.spatial.transform import Rotation

from schemas.problem import InternalError
from worker.evaluation.aha_segments import APEX, NAMES, NONE, LeftVentricle, aha_segments

LPS = {"left": (1.0, 0.0, 0.0), "anterior": (0.0, -1.0, 0.0), "up": (0.0, 0.0, 1.0)}
RAS = {"left": (-1.0, 0.0, 0.0), "anterior": (0.0, 1.0, 0.0), "up": (0.0, 0.0, 1.0)}


def upright(axes: dict[str, tuple[float, float, float]]) -> LeftVentricle:
    """A heart that stands on its apex, its right ventricle on the patient's right."""
    right = -np.array(axes["left"])
    return LeftVentricle(np.zeros(3), np.array(axes["up"]), right, apex_mm=-30.0, base_mm=30.0)


def around(axes: dict[str, tuple[float, float, float]], degrees: float, height: float) -> list:
    """A point of the wall: 0 degrees to the patient's right, 90 to the front."""
    right, front, up = -np.array(axes["left"]), np.array(axes["anterior"]), np.array(axes["up"])
    angle = np.radians(degrees)
    return list(25.0 * (np.cos(angle) * right + np.sin(angle) * front) + height * up)


@pytest.mark.parametrize("axes", [LPS, RAS], ids=["LPS", "RAS"])
@pytest.mark.parametrize(("height", "first"), [(20.0, 0), (0.0, 6)])
def test_six_segments_go_from_the_front_over_the_septum_to_the_side(
    axes: dict, height: float, first: int
) -> None:
    degrees = [90.0, 30.0, 330.0, 270.0, 210.0, 150.0]
    points = np.array([around(axes, angle, height) for angle in degrees])
    np.testing.assert_array_equal(aha_segments(points, upright(axes)), first + np.arange(1, 7))


@pytest.mark.parametrize("axes", [LPS, RAS], ids=["LPS", "RAS"])
def test_four_apical_segments(axes: dict) -> None:
    points = np.array([around(axes, angle, -20.0) for angle in (90.0, 0.0, 270.0, 180.0)])
    np.testing.assert_array_equal(aha_segments(points, upright(axes)), [13, 14, 15, 16])


def test_names_agree_with_where_they_are() -> None:
    """By their words: the front is anterior, the patient's right is the septum."""
    ventricle = upright(LPS)
    for height, level in ((20.0, "basal"), (0.0, "mid"), (-20.0, "apical")):
        for degrees in range(0, 360, 5):
            x, y, _ = (point := around(LPS, degrees + 1.0, height))
            name = NAMES[int(aha_segments(np.array([point]), ventricle)[0])]
            assert name.startswith(level)
            if name.endswith(("septal", "lateral")):
                assert (x < 0.0) == name.endswith("septal")
            else:
                assert (y < 0.0) == name.endswith("anterior")


def test_the_apex_is_below_the_cavity_and_nothing_above_the_base() -> None:
    points = np.array([around(LPS, 40.0, height) for height in (-30.1, -29.9, 29.9, 30.1)])
    found = aha_segments(points, upright(LPS)).tolist()
    assert (found[0], found[3]) == (APEX, NONE)
    assert found[1] in (13, 14)
    assert found[2] in (1, 2)


def test_equal_angles_and_heights_are_equal_shares() -> None:
    degrees, heights = np.meshgrid(np.arange(0.5, 360.0), np.linspace(-29.9, 29.9, 90))
    points = np.array([around(LPS, d, h) for d, h in zip(degrees.flat, heights.flat, strict=True)])
    numbers, counts = np.unique(aha_segments(points, upright(LPS)), return_counts=True)
    assert numbers.tolist() == list(range(1, 17))
    shares = counts / len(points)
    np.testing.assert_allclose(shares[:12], 1 / 18, rtol=1e-6)
    np.testing.assert_allclose(shares[12:], 1 / 12, rtol=1e-6)


def test_segments_move_with_the_heart() -> None:
    rng = np.random.default_rng(0)
    points, ventricle = rng.normal(0.0, 20.0, (500, 3)), upright(LPS)
    turn, shift = (
        Rotation.from_euler("xyz", [0.4, -1.1, 2.0]).as_matrix(),
        np.array([9.0, 4.0, 7.0]),
    )
    moved = LeftVentricle(
        shift,
        turn @ ventricle.toward_base,
        turn @ (3.0 * ventricle.toward_rv + 2.0 * ventricle.toward_base),
        ventricle.apex_mm,
        ventricle.base_mm,
    )
    np.testing.assert_array_equal(
        aha_segments(points @ turn.T + shift, moved), aha_segments(points, ventricle)
    )


def test_an_apex_above_the_base_is_refused() -> None:
    with pytest.raises(InternalError, match="turn the long axis"):
        LeftVentricle(np.zeros(3), np.array([0.0, 0.0, 1.0]), np.array([1.0, 0.0, 0.0]), 5.0, -5.0)
