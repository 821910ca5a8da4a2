"""A structure's outlines as points with in-plane normals, and the room there is beside them."""

from collections.abc import Callable
from dataclasses import dataclass

import numpy as np
from scipy.spatial import cKDTree

from intake.even_odd import inside
from intake.planes import Plane
from schemas.vocabulary import Structure, View
from worker.arrays import Flags, Points, Scalars
from worker.interpolation.outline_points import evenly_along
from worker.reconstruction.slice_stack import Outline, SliceStack, StackSlice

_FINE_MM = 0.25
"""Step along an outline for tangents and for the room beside it."""
_CHORD = 4
"""A tangent is taken over this many fine steps either way: 1 mm, less than an outline turns in."""
_PROBE_MM = 0.05
"""How far to a side the even-odd rule is asked which side is outside."""
_STEP_MM = 0.25
"""Of central differences for a field's gradient."""
_LEAST_COSINE = 0.25
_HALVINGS = 2
"""A narrow place lets an off-surface point come as near as d / 4; narrower ones have none."""


@dataclass(frozen=True, eq=False)
class ContourSamples:
    """Points on the outlines of one structure, patient mm.

    normals: (n, 3) unit, in the slice's plane, outward. outer_mm, inner_mm: (n,) how far along the
    normal, and against it, an off-surface point may be; nan where another part of the outline is
    too near. short_axis: (n,) whether the point is on a short-axis slice.
    """

    points_mm: Points
    normals: Points
    outer_mm: Scalars
    inner_mm: Scalars
    short_axis: Flags

    def cosines(self, field: Callable[[Points], Scalars]) -> Scalars:
        """Cosine (n,) of the angle at which the level sets of `field`, positive inside, lean from
        the slice at each point; no less than 0.25: beyond, outlines and field disagree.
        """
        steps = _STEP_MM * np.eye(3)
        slopes = [field(self.points_mm + s) - field(self.points_mm - s) for s in steps]
        gradient = np.stack(slopes, axis=1)
        steepness = np.maximum(np.linalg.norm(gradient, axis=1), 1e-12)
        along = -np.einsum("nk,nk->n", gradient, self.normals)
        return np.clip(along / steepness, _LEAST_COSINE, 1.0)


def contour_samples(
    stack: SliceStack, structure: Structure, spacing_mm: float, off_surface_mm: float
) -> ContourSamples:
    """All outlines of `structure`, every `spacing_mm`; the chord of an open one is no outline."""
    parts = [
        _of_slice(s, outlines, spacing_mm, off_surface_mm)
        for s in stack.slices
        if (outlines := s.outlines.get(structure))
    ]
    return ContourSamples(
        points_mm=np.concatenate([part.points_mm for part in parts]),
        normals=np.concatenate([part.normals for part in parts]),
        outer_mm=np.concatenate([part.outer_mm for part in parts]),
        inner_mm=np.concatenate([part.inner_mm for part in parts]),
        short_axis=np.concatenate([part.short_axis for part in parts]),
    )


def _of_slice(
    slice_: StackSlice,
    outlines: tuple[Outline, ...],
    spacing_mm: float,
    off_surface_mm: float,
) -> ContourSamples:
    plane = Plane.through(slice_.origin_mm, slice_.normal)
    flat = [plane.to_plane(o.points_mm) for o in outlines]
    fine = [
        evenly_along(ring, _FINE_MM, closed=o.closed)
        for ring, o in zip(flat, outlines, strict=True)
    ]
    sparse = [
        evenly_along(ring, spacing_mm, closed=o.closed)
        for ring, o in zip(flat, outlines, strict=True)
    ]
    points = np.concatenate(sparse)
    normals = np.concatenate(
        [
            _normals(at, along, closed=o.closed)
            for at, along, o in zip(sparse, fine, outlines, strict=True)
        ]
    )
    normals[inside(points + _PROBE_MM * normals, flat)] *= -1.0
    tree = cKDTree(np.concatenate(fine))
    outer = _room(points, normals, off_surface_mm, tree, flat, within=False)
    inner = _room(points, -normals, off_surface_mm, tree, flat, within=True)
    return ContourSamples(
        points_mm=plane.to_space(points),
        normals=normals @ np.stack([plane.u, plane.v]),
        outer_mm=outer,
        inner_mm=inner,
        short_axis=np.full(len(points), slice_.view is View.SAX),
    )


def _normals(points: np.ndarray, along: np.ndarray, *, closed: bool) -> np.ndarray:
    """Unit vectors (n, 2) across the outline `along` at the points nearest to `points`."""
    _, at = cKDTree(along).query(points)
    if closed:
        before, after = (at - _CHORD) % len(along), (at + _CHORD) % len(along)
    else:
        before, after = np.maximum(at - _CHORD, 0), np.minimum(at + _CHORD, len(along) - 1)
    tangents = along[after] - along[before]
    across = np.column_stack([tangents[:, 1], -tangents[:, 0]])
    return across / np.maximum(np.linalg.norm(across, axis=1, keepdims=True), 1e-12)


def _room(
    points: np.ndarray,
    directions: np.ndarray,
    largest_mm: float,
    tree: cKDTree,
    rings: list[np.ndarray],
    *,
    within: bool,
) -> np.ndarray:
    """The largest of d, d/2, d/4 at which the point's own outline is still the nearest; or nan."""
    room = np.full(len(points), np.nan)
    for step in largest_mm * 0.5 ** np.arange(_HALVINGS + 1):
        there = points + step * directions
        away, _ = tree.query(there)
        fits = np.isnan(room) & (away > 0.9 * step) & (inside(there, rings) == within)
        room[fits] = step
    return room
