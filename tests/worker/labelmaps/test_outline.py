"""Outlines of masks: the area of the pixels, sub-pixel near the truth, no staircase."""

from collections.abc import Callable

import numpy as np
import pytest
import shapely
import shapely.affinity
from hypothesis import given, settings
from hypothesis.extra.numpy import arrays

from worker.labelmaps.outline import outlines, smooth_region, without_specks

WHOLE = (slice(0, 64), slice(0, 64))
Shape = Callable[[float, float], shapely.Geometry]


def disc(radius: float) -> Shape:
    return lambda x, y: shapely.Point(x, y).buffer(radius, quad_segs=64)


def ellipse(x: float, y: float) -> shapely.Geometry:
    stretched = shapely.affinity.scale(shapely.Point(x, y).buffer(1.0, quad_segs=64), 25.0, 9.0)
    return shapely.affinity.rotate(stretched, 33.0)


def crescent(x: float, y: float) -> shapely.Geometry:
    whole = shapely.affinity.scale(shapely.Point(x + 10, y).buffer(1.0, quad_segs=64), 18.0, 24.0)
    return shapely.affinity.rotate(whole.difference(disc(20.0)(x - 8, y)), 20.0)


SHAPES = {"disc 8": disc(8.0), "disc 20": disc(20.0), "ellipse": ellipse, "crescent": crescent}


def rasterised(shape: shapely.Geometry, size: int = 64) -> np.ndarray:
    i, j = np.indices((size, size))
    return shapely.contains_xy(shape, i.ravel(), j.ravel()).reshape(size, size)


def polygon(rings: list[np.ndarray]) -> shapely.Geometry:
    """Even-odd fill."""
    filled = shapely.Polygon()
    for ring in rings:
        filled = filled.symmetric_difference(shapely.Polygon(ring))
    return filled


def outlined(mask: np.ndarray, step: float = 1.0) -> list[np.ndarray]:
    box = (slice(0, mask.shape[0]), slice(0, mask.shape[1]))
    return outlines(smooth_region(mask, box), step)


@pytest.mark.parametrize("name", SHAPES)
@pytest.mark.parametrize("seed", range(5))
def test_area_is_that_of_the_pixels_and_outline_near_the_truth(name: str, seed: int) -> None:
    x, y = 31.5 + np.random.default_rng(seed).uniform(-0.5, 0.5, 2)
    shape = SHAPES[name](x, y)
    mask = rasterised(shape)
    rings = outlined(mask)
    assert len(rings) == 1
    assert polygon(rings).area == pytest.approx(mask.sum(), rel=5e-3)
    away = shapely.distance(shape.exterior, shapely.points(rings[0]))
    assert away.mean() < 0.2
    # The horns of a crescent are narrower than a pixel, and a blur rounds them.
    assert away.max() < (1.2 if name == "crescent" else 0.6)


@pytest.mark.parametrize("radius", [8.0, 12.0, 20.0, 28.0])
def test_a_disc_comes_back_within_one_percent(radius: float) -> None:
    """On average over its place between the pixels, which rasterising itself does not keep."""
    generator = np.random.default_rng(1)
    areas = [
        polygon(outlined(rasterised(disc(radius)(*generator.uniform(31, 32, 2))))).area
        for _ in range(10)
    ]
    assert np.mean(areas) == pytest.approx(np.pi * radius**2, rel=0.01)


@pytest.mark.parametrize("radius", [2.0, 3.0, 4.0])
def test_an_apical_disc_does_not_shrink(radius: float) -> None:
    mask = rasterised(disc(radius)(31.3, 31.6))
    assert polygon(outlined(mask)).area == pytest.approx(mask.sum(), rel=0.05)


def test_no_staircase() -> None:
    """Along a slanting edge the direction changes by a few degrees a point, not by 90."""
    mask = rasterised(disc(24.0)(31.4, 31.7))
    ring = outlined(mask)[0]
    x, y = (np.roll(ring, -1, axis=0) - ring).T
    directions = np.unwrap(np.arctan2(y, x))
    turns = np.degrees(np.diff(directions))
    assert np.abs(turns).max() < 25.0
    assert turns.std() < 8.0


def test_points_are_evenly_spaced_and_the_first_is_not_repeated() -> None:
    ring = outlined(rasterised(disc(20.0)(31.4, 31.7)), step=2.0)[0]
    lengths = np.linalg.norm(np.roll(ring, -1, axis=0) - ring, axis=1)
    assert len(ring) == pytest.approx(2 * np.pi * 20.0 / 2.0, rel=0.03)
    assert lengths.max() < 1.1 * lengths.min()


def test_large_holes_are_kept_for_even_odd_filling() -> None:
    ring = disc(22.0)(31.5, 31.5).difference(disc(10.0)(31.5, 31.5))
    mask, _ = without_specks(rasterised(ring), fill_holes=False)
    rings = outlined(mask)
    assert len(rings) == 2
    assert polygon(rings).area == pytest.approx(mask.sum(), rel=5e-3)


def test_closing_holes() -> None:
    ring = disc(22.0)(31.5, 31.5).difference(disc(10.0)(31.5, 31.5))
    mask, dropped = without_specks(rasterised(ring), fill_holes=True)
    np.testing.assert_array_equal(mask, rasterised(disc(22.0)(31.5, 31.5)))
    assert dropped == 0


def test_specks_and_pinholes_go() -> None:
    clean = rasterised(disc(10.0)(31.5, 31.5))
    dirty = clean.copy()
    dirty[31, 31] = False
    dirty[5, 5:8] = True
    dirty[60, 60] = True
    mask, dropped = without_specks(dirty, fill_holes=False)
    np.testing.assert_array_equal(mask, clean)
    assert dropped == 2


def test_a_mask_at_the_border_of_the_image_is_outlined_there() -> None:
    mask = rasterised(disc(12.0)(3.0, 31.5))
    rings = outlined(mask)
    assert polygon(rings).area == pytest.approx(mask.sum(), rel=5e-3)
    assert rings[0][:, 0].min() == pytest.approx(-0.5, abs=0.2)


def test_regions_meet_and_never_cross() -> None:
    """A horseshoe of wall leaves cavity and union with a common border."""
    cavity = disc(14.0)(31.4, 31.6)
    wall = disc(18.0)(31.4, 31.6).difference(shapely.box(34.0, 0.0, 64.0, 64.0)).difference(cavity)
    inner = rasterised(cavity)
    outer = inner | rasterised(wall)
    right = rasterised(shapely.box(34.0, 10.0, 60.0, 55.0)) & ~outer
    left = smooth_region(outer, WHOLE)
    inside = polygon(outlines(smooth_region(inner, WHOLE).within(left), 1.0))
    beside = polygon(outlines(smooth_region(right, WHOLE).outside(left), 1.0))
    around = polygon(outlines(left, 1.0))
    assert inside.difference(around).area < 0.01 * inside.area
    assert beside.intersection(around).area < 0.01 * beside.area
    assert inside.area == pytest.approx(inner.sum(), rel=0.02)


def test_coordinates_are_those_of_the_image_whatever_the_box() -> None:
    mask = rasterised(disc(10.0)(40.2, 25.7))
    box = (slice(29, 52), slice(14, 38))
    cropped = outlines(smooth_region(mask, box), 1.0)[0]
    np.testing.assert_allclose(cropped.mean(axis=0), [40.2, 25.7], atol=0.1)


@settings(max_examples=150, deadline=None)
@given(arrays(bool, (14, 11)))
def test_any_mask_is_outlined(mask: np.ndarray) -> None:
    kept, _ = without_specks(mask, fill_holes=False)
    if kept.any():
        for ring in outlined(kept):
            assert np.isfinite(ring).all()
            assert shapely.Polygon(ring).area > 0.0
