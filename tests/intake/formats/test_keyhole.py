"""Keyholes: taken apart wherever the outline starts, and nothing else is."""

import numpy as np
import pytest

from intake.formats.keyhole import split_keyholes
from intake.simplicity import shoelace_mm2


def ring(radius: float, x: float = 0.0, points: int = 40) -> np.ndarray:
    angle = np.linspace(0, 2 * np.pi, points, endpoint=False)
    return np.stack(
        [x + radius * np.cos(angle), radius * np.sin(angle), np.full(points, 7.0)], axis=1
    )


def keyhole(outer: np.ndarray, inner: np.ndarray, channel: int = 0) -> np.ndarray:
    """Outer outline, `channel` points on the way, inner outline the other way about, and back."""
    way = np.linspace(outer[0], inner[0], channel + 2)[1:-1]
    return np.concatenate([outer, outer[:1], way, inner[:1], inner[:0:-1], inner[:1], way[::-1]])


def areas(parts: list[np.ndarray]) -> list[float]:
    return sorted(abs(shoelace_mm2(part[:, :2])) for part in parts)


@pytest.mark.parametrize("channel", [0, 1, 5])
def test_outline_and_hole_come_apart_wherever_the_outline_starts(channel: int) -> None:
    outer, inner = ring(20), ring(8)
    whole = keyhole(outer, inner, channel)
    for turn in range(len(whole)):
        parts = split_keyholes(np.roll(whole, turn, axis=0))
        assert areas(parts) == pytest.approx(areas([outer, inner]), abs=1e-9), turn
        assert sorted(map(len, parts)) == [40, 40]


def test_two_holes() -> None:
    outer, left, right = ring(30), ring(5, x=-12)[::-1], ring(6, x=12)
    first = keyhole(outer, right)
    second = np.roll(first, -20, axis=0)
    left = np.roll(left, -int(np.argmin(left[:, 0])), axis=0)
    parts = split_keyholes(keyhole(second, left))
    assert areas(parts) == pytest.approx(areas([outer, left, right]), abs=1e-9)


def test_written_with_three_decimals() -> None:
    whole = keyhole(ring(20), ring(8), 3).round(3)
    assert len(split_keyholes(whole)) == 2


@pytest.mark.parametrize(
    "outline",
    [
        ring(20),
        np.concatenate([ring(20), [[30.0, 0, 7], [20.0, 0, 7]]]),  # a whisker
        ring(20, points=3),
        np.concatenate([ring(20), ring(20)]),  # twice round
    ],
    ids=["circle", "whisker", "triangle", "twice"],
)
def test_what_has_no_channel_stays_whole(outline: np.ndarray) -> None:
    (part,) = split_keyholes(outline)
    np.testing.assert_array_equal(part, outline)


def test_outlines_that_touch_themselves_everywhere() -> None:
    """The longest that are taken: comparing every pair of points, each to its end, takes hours."""
    there = np.stack([np.arange(2500.0), np.zeros(2500), np.zeros(2500)], axis=1)
    zigzag = np.tile(there[:2], (2500, 1))
    for outline in (np.concatenate([there, there[::-1]]), zigzag, np.zeros((5000, 3))):
        assert len(split_keyholes(outline)) <= 32
