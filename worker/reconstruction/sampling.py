"""Hierarchical samples of one refinement level: on the slices, closing in on the contours.

On every slice: points on the contours (occupancy 0.5), points within the level's radius of them,
and points spread over the whole plane; beyond the slices: the inflated hull and everything outside
it. Paper, section "Dataset sampling"; the radii follow OReX (arXiv 2211.12886).
"""

from collections.abc import Sequence

import numpy as np

from intake.even_odd import inside
from schemas.options import SamplingOptions
from schemas.vocabulary import Structure
from worker.arrays import PlanePoints, Scalars
from worker.observer import Cancelled, Observer
from worker.reconstruction.hull import Hull
from worker.reconstruction.samples import BOUNDARY, NO_SLICE, LabelledSamples, joined
from worker.reconstruction.unit_stack import UnitOutline, UnitSlice, UnitStack

_PLANE_MARGIN = 1.15
"""How far beyond all contours a plane is sampled, as a factor of their extent."""


def level_radius(level: int, levels: int, options: SamplingOptions) -> float:
    """Distance to the contours within which level `level` of `levels` samples, unit lengths."""
    if levels == 1:
        return options.last_radius
    ratio = options.last_radius / options.first_radius
    return float(options.first_radius * ratio ** (level / (levels - 1)))


def sample_level(
    stack: UnitStack,
    surfaces: Sequence[Structure],
    hull: Hull,
    radius: float,
    options: SamplingOptions,
    rng: np.random.Generator,
    observer: Observer,
) -> LabelledSamples:
    """Fresh samples of a level, `targets` and `known` in the order of `surfaces`.

    Raises Cancelled when the observer asks to stop.
    """
    everywhere = stack.points_unit
    parts = []
    for index, slice_ in enumerate(stack.slices):
        if observer.is_cancelled():
            raise Cancelled
        extent = slice_.drop(everywhere)
        parts += _on_slice(slice_, index, surfaces, extent, radius, options, rng)
    parts.append(_outside(hull, len(surfaces), options, rng))
    return joined(parts)


def _on_slice(
    slice_: UnitSlice,
    index: int,
    surfaces: Sequence[Structure],
    extent: PlanePoints,
    radius: float,
    options: SamplingOptions,
    rng: np.random.Generator,
) -> list[LabelledSamples]:
    low, high = extent.min(axis=0), extent.max(axis=0)
    centre, half = 0.5 * (low + high), 0.5 * _PLANE_MARGIN * (high - low)
    spread = rng.uniform(centre - half, centre + half, (options.uniform_samples_per_plane, 2))
    parts = [_labelled(slice_, index, surfaces, spread)]

    owners, outlines = _observed_outlines(slice_, surfaces)
    if outlines:
        count = options.contour_samples_per_plane
        on_contour, owner = _along(outlines, owners, count, rng)
        near = on_contour + radius * rng.standard_normal((count, 2))
        parts.append(_labelled(slice_, index, surfaces, near))
        boundary = _labelled(slice_, index, surfaces, on_contour)
        boundary.targets[np.arange(count), owner] = BOUNDARY
        parts.append(boundary)
    return parts


def _labelled(
    slice_: UnitSlice, index: int, surfaces: Sequence[Structure], in_plane: PlanePoints
) -> LabelledSamples:
    """Occupancy of `in_plane` by the even-odd rule, and which surfaces the slice speaks of."""
    n = len(in_plane)
    targets = np.zeros((n, len(surfaces)))
    known = np.zeros((n, len(surfaces)), dtype=bool)
    for column, structure in enumerate(surfaces):
        outlines = slice_.outlines.get(structure, ())
        if outlines:
            targets[:, column] = inside(in_plane, [o.points for o in outlines])
        known[:, column] = bool(outlines) or structure in slice_.absent
    return LabelledSamples(slice_.lift(in_plane), targets, known, np.full(n, index))


def _observed_outlines(
    slice_: UnitSlice, surfaces: Sequence[Structure]
) -> tuple[list[int], list[UnitOutline]]:
    pairs = [
        (column, outline)
        for column, structure in enumerate(surfaces)
        for outline in slice_.outlines.get(structure, ())
    ]
    return [column for column, _ in pairs], [outline for _, outline in pairs]


def _along(
    outlines: Sequence[UnitOutline],
    owners: Sequence[int],
    count: int,
    rng: np.random.Generator,
) -> tuple[PlanePoints, np.ndarray]:
    """Points spread evenly along the outlines' observed edges, and whose surface each is on."""
    edges = [outline.edges for outline in outlines]
    starts = np.concatenate([start for start, _ in edges])
    ends = np.concatenate([end for _, end in edges])
    owner = np.repeat(np.asarray(owners), [len(start) for start, _ in edges])
    lengths: Scalars = np.linalg.norm(ends - starts, axis=1)
    chosen = rng.choice(len(starts), size=count, p=lengths / lengths.sum())
    t = rng.random((count, 1))
    return starts[chosen] + t * (ends[chosen] - starts[chosen]), owner[chosen]


def _outside(
    hull: Hull, surface_count: int, options: SamplingOptions, rng: np.random.Generator
) -> LabelledSamples:
    points = np.concatenate(
        [hull.on_surface(options.hull_samples, rng), hull.beyond(options.far_samples, rng)]
    )
    n = len(points)
    return LabelledSamples(
        points,
        np.zeros((n, surface_count)),
        np.ones((n, surface_count), dtype=bool),
        np.full(n, NO_SLICE),
    )
