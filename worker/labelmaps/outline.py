"""Outlines of a mask at sub-pixel precision: no staircase, and the area of its pixels.

The mask is blurred a little over a pixel, which removes the staircase, and contoured by marching
squares at the level whose outline encloses as much as the pixels did. Half the maximum would not:
blurring pulls a convex outline inwards by about sigma^2 / (2 radius), more than 5 % of the area of
an apical cavity.
"""

from dataclasses import dataclass

import numpy as np
from jaxtyping import Bool, Float
from scipy.ndimage import gaussian_filter, label
from scipy.optimize import brentq
from skimage.measure import find_contours

Mask = Bool[np.ndarray, "i j"]
Field = Float[np.ndarray, "i j"]
Ring = Float[np.ndarray, "_ 2"]
"""One outline, pixel coordinates. Anonymous, since rings of a list differ in length."""

_SIGMA = 1.2
"""Blur, pixels. Of 0.8 to 2, least mean error for an ellipse and a crescent (0.10, 0.12 pixel);
discs would take more (0.10 at 1.2, 0.08 at 2 for a radius of 20), and narrow horns less."""
_MARGIN = 6
"""Pixels around a mask; the blur ends at four sigma."""
_LEAST_PIXELS = 5
"""A piece or a hole of fewer pixels is a slip of the brush."""
_LEAST_AREA = 2.0
"""Square pixels below which a ring is a sliver left between two regions."""
_LEAST_POINTS = 16
_LEVELS = (0.05, 0.95)
_EIGHT = np.ones((3, 3), dtype=bool)


@dataclass(frozen=True, eq=False)
class Region:
    """A smoothed mask: positive inside, zero on its outline, in pixel coordinates of the image.

    offset: pixel (of the image) at which the field begins.
    """

    field: Field
    offset: tuple[int, int]

    def within(self, other: "Region") -> "Region":
        """The part inside `other`, so that their outlines meet and never cross."""
        return Region(np.minimum(self.field, other.field), self.offset)

    def outside(self, other: "Region") -> "Region":
        """The part outside `other`."""
        return Region(np.minimum(self.field, -other.field), self.offset)


def without_specks(mask: Mask, *, fill_holes: bool) -> tuple[Mask, int]:
    """The mask without pieces and holes of a few pixels, and how many pieces were dropped.

    With `fill_holes`, holes of any size are closed: what encloses a cavity has none.
    """
    pieces, count = label(mask, _EIGHT)
    sizes = np.bincount(pieces.ravel(), minlength=count + 1)
    kept = sizes >= _LEAST_PIXELS
    kept[0] = False
    solid: Mask = kept[pieces]
    return ~_without_small_holes(~solid, fill_holes), int(count - kept.sum())


def _without_small_holes(background: Mask, fill_holes: bool) -> Mask:
    regions, _ = label(np.pad(background, 1, constant_values=True))
    sizes = np.bincount(regions.ravel())
    outer = regions[0, 0]
    kept = np.zeros_like(sizes, dtype=bool) if fill_holes else sizes >= _LEAST_PIXELS
    kept[outer] = True
    kept[0] = False
    inner: Mask = kept[regions][1:-1, 1:-1]
    return inner


def smooth_region(mask: Mask, box: tuple[slice, slice]) -> Region:
    """The mask, not empty, as a region over `box` of the image, of the same area as its pixels.

    Regions over the same box can be combined.
    """
    rows, columns = box
    padded = np.pad(mask[box].astype(np.float64), _MARGIN)
    blurred = gaussian_filter(padded, _SIGMA, mode="constant")
    area = float(mask[box].sum())

    def excess(level: float) -> float:
        return _enclosed(blurred, level) - area

    low, high = _LEVELS[0], min(_LEVELS[1], float(blurred.max()) * 0.999)
    level = brentq(excess, low, high, xtol=1e-4)
    return Region(blurred - level, (rows.start - _MARGIN, columns.start - _MARGIN))


def outlines(region: Region, step: float) -> list[Ring]:
    """Closed outlines in pixel coordinates, a point about every `step` pixels, first not repeated.

    Outer outlines and holes alike, for even-odd filling.
    """
    rings = find_contours(region.field, 0.0)
    return [
        _evenly(ring, step) + region.offset for ring in rings if abs(_area(ring)) >= _LEAST_AREA
    ]


def _evenly(ring: Ring, step: float) -> Ring:
    """The closed ring resampled at equal distances along it."""
    lengths = np.linalg.norm(np.diff(ring, axis=0), axis=1)
    along = np.concatenate([[0.0], np.cumsum(lengths)])
    count = max(int(np.ceil(along[-1] / step)), _LEAST_POINTS)
    places = np.arange(count) * (along[-1] / count)
    return np.column_stack([np.interp(places, along, ring[:, k]) for k in (0, 1)])


def _enclosed(field: Field, level: float) -> float:
    """Area inside the outlines of a level, holes taken off, pixels."""
    return abs(sum(_area(ring) for ring in find_contours(field, level)))


def _area(ring: Ring) -> float:
    """Signed area of a ring whose last point repeats the first."""
    x, y = ring[:, 0], ring[:, 1]
    return 0.5 * float(np.dot(x[:-1], y[1:]) - np.dot(x[1:], y[:-1]))
