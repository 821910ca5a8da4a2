"""Lofting: a smooth skin over the outlines of a short-axis stack, joined point to point.

Each slice gives one ring of equally many points; a piecewise cubic spline runs through
corresponding ones: Akima's (JACM 17(4), 1970), the best of four kinds tried on real hearts.
"""

from itertools import pairwise

import numpy as np
from scipy.interpolate import Akima1DInterpolator

from schemas.vocabulary import Structure
from worker.arrays import Faces
from worker.interpolation.outline_points import at_fractions
from worker.interpolation.short_axis import Rings, short_axis_stack
from worker.reconstruction.component import outward
from worker.reconstruction.slice_stack import SliceStack
from worker.surface_mesh import SurfaceMesh

_CAP_RINGS = 6
"""Rings of the dome at either end, the last one being a point."""


def lofted(stack: SliceStack, structure: Structure, *, edge_mm: float = 1.25) -> SurfaceMesh:
    """The surface of `structure`, closed, outward, patient mm.

    Outlines are divided into equal lengths, and each ring is turned to where it is nearest to the
    one below, both centred: least twist. The spline over the height joins them. Domes close the
    ends half a slice gap beyond the first and last slice, or halfway to a nearer one where the
    structure is absent. Short-axis slices only. Of a slice with several outlines the largest is
    taken: a skin has no branches. edge_mm: about the length of the triangles' edges.
    Raises InputError for fewer than two short-axis slices, or for slices that are not a stack.
    """
    slices = short_axis_stack(stack, structure)
    outlines = [_largest(rings) for rings in slices.rings]
    count = int(np.ceil(max(_length(outline) for outline in outlines) / edge_mm))
    rings = _in_step([at_fractions(outline, count, closed=True) for outline in outlines])
    heights = slices.heights_mm
    levels = _levels(heights, edge_mm)
    skin = Akima1DInterpolator(heights, rings)(levels)
    below, low = _dome(skin[0], slices.bottom_mm - heights[0])
    above, high = _dome(skin[-1], slices.top_mm - heights[-1])
    walls = np.concatenate([below[::-1], skin, above])
    at = np.concatenate([(heights[0] + low)[::-1], levels, heights[-1] + high])
    in_plane = np.concatenate([walls.reshape(-1, 2), skin[[0, -1]].mean(axis=1)])
    height = np.concatenate([np.repeat(at, count), [slices.bottom_mm, slices.top_mm]])
    vertices = slices.to_space(in_plane, height)
    return SurfaceMesh(vertices, outward(vertices, _tube(len(walls), count)))


def _largest(rings: Rings) -> np.ndarray:
    """The outline that encloses most, counter-clockwise."""
    areas = [_area(ring) for ring in rings]
    chosen = int(np.argmax(np.abs(areas)))
    return rings[chosen] if areas[chosen] > 0.0 else rings[chosen][::-1]


def _area(ring: np.ndarray) -> float:
    x, y = (ring - ring[0]).T
    return float(x @ np.roll(y, -1) - y @ np.roll(x, -1)) / 2.0


def _length(ring: np.ndarray) -> float:
    return float(np.linalg.norm(np.roll(ring, -1, axis=0) - ring, axis=1).sum())


def _in_step(rings: list[np.ndarray]) -> np.ndarray:
    """The same rings (slices, count, 2), each begun at the point that matches the one below."""
    turned = [rings[0]]
    for ring in rings[1:]:
        below, above = ((r - r.mean(axis=0)) @ (1.0, 1.0j) for r in (turned[-1], ring))
        # Largest inner product: least sum of squared distances over all beginnings, by FFT.
        match = np.fft.ifft(np.conj(np.fft.fft(below)) * np.fft.fft(above)).real
        turned.append(np.roll(ring, -int(np.argmax(match)), axis=0))
    return np.stack(turned)


def _levels(heights: np.ndarray, edge_mm: float) -> np.ndarray:
    """The slices' heights, and others evenly between them."""
    between = [
        np.linspace(low, high, max(1, round((high - low) / edge_mm)), endpoint=False)
        for low, high in pairwise(heights)
    ]
    return np.concatenate([*between, heights[-1:]])


def _dome(ring: np.ndarray, reach_mm: float) -> tuple[np.ndarray, np.ndarray]:
    """Ever smaller rings (k, count, 2) and their heights (k,) from the ring's: half an ellipse.

    Shrunk about their centroid they stay simple, and rings at different heights never cross.
    """
    angle = np.linspace(0.0, np.pi / 2.0, _CAP_RINGS + 1)[1:-1]
    middle = ring.mean(axis=0)
    rings = middle + np.cos(angle)[:, None, None] * (ring - middle)
    return rings, reach_mm * np.sin(angle)


def _tube(rings: int, count: int) -> Faces:
    """Triangles between `rings` rings of `count` points each, and fans to the two poles after."""
    here = np.arange(count)
    there = np.roll(here, -1)
    offset = (count * np.arange(rings - 1))[:, None]
    a, b = offset + here, offset + there
    c, d = a + count, b + count
    side = np.concatenate(
        [np.stack(corners, axis=-1).reshape(-1, 3) for corners in ((a, b, d), (a, d, c))]
    )
    last = count * (rings - 1)
    bottom = np.column_stack([there, here, np.full(count, count * rings)])
    top = np.column_stack([last + here, last + there, np.full(count, count * rings + 1)])
    return np.concatenate([side, bottom, top])
