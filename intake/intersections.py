"""Do slices that cross agree along the lines they share?"""

from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

from intake.edges import batches, edges_of, order_along
from intake.even_odd import widths
from intake.placed import PlacedFrame, PlacedSlice
from schemas.problem import InputError, ProblemType
from schemas.vocabulary import Structure

Array = NDArray[np.float64]
Indices = NDArray[np.intp]

REFUSED_BELOW, NOTED_BELOW = 0.4, 0.8
"""Shared over joint length of the structures along all lines. Hearts whose slices were shifted by
3 mm reach 0.92; long-axis views in other axes than the short-axis stack 0.2 to 0.5."""

_CROSSING_COSINE = float(np.cos(np.deg2rad(20.0)))

_PAIRS = 200
"""Pairs of slices looked at in a frame, evenly chosen when there are more."""

_POINTS_AT_ONCE = 1_000_000
"""Points times lines of one step; bounds its memory."""

_NUMBER = {structure: number for number, structure in enumerate(Structure)}


def check_intersections(frame: PlacedFrame, extent_mm: float) -> list[str]:
    """A warning when crossing slices agree badly.

    Raises:
        InputError: `CONTRADICTING_SLICES` when they do not agree at all.
    """
    outlined = [s for s in frame.slices if s.contours]
    pairs = _crossing_pairs(outlined)
    pairs = pairs[:: 1 + len(pairs) // _PAIRS]
    shared, joint = _along_lines(outlined, pairs)
    whole_mm = float(joint.sum())
    likeness = float(shared.sum()) / whole_mm if whole_mm else 1.0
    if likeness >= NOTED_BELOW or whole_mm < 0.5 * extent_mm:
        return []
    unlike = np.zeros(len(outlined))
    for side in range(2):
        np.add.at(unlike, pairs[:, side], joint - shared)
    worst = outlined[int(np.argmax(unlike))]
    said = (
        f"Frame {frame.label}: along the lines where slices cross, their contours share only "
        f"{100 * likeness:.0f} %; slice {worst.id} disagrees most"
    )
    if likeness >= REFUSED_BELOW:
        return [f"{said}. Check that its plane is right and that it is of the same instant."]
    raise InputError(
        ProblemType.CONTRADICTING_SLICES,
        f"{said}. Remedy: give all slices in the same axes (LPS or RAS) and units, of one subject "
        "at one instant, each with its own plane.",
        pointer=worst.pointer,
    )


def _crossing_pairs(slices: list[PlacedSlice]) -> Indices:
    """Which slices (k, 2) cross at a steep enough angle."""
    if not slices:
        return np.empty((0, 2), dtype=np.intp)
    normals = np.stack([s.plane.normal for s in slices])
    return np.argwhere(np.triu(np.abs(normals @ normals.T) < _CROSSING_COSINE))


def _along_lines(slices: list[PlacedSlice], pairs: Indices) -> tuple[Array, Array]:
    """Of the common line of each pair (k, 2) of planes, the length (k,), mm, that lies inside a
    structure on both slices, and on either; summed over the structures that both show.
    """
    if not len(pairs):
        return np.zeros(0), np.zeros(0)
    lines = _Lines.of(slices, pairs)
    ends = [
        lines.ends(slice_, at, side)
        for at, slice_ in enumerate(slices)
        for side in range(2)
        if (pairs[:, side] == at).any()
    ]
    key = np.concatenate([keys for keys, _ in ends])
    x = np.concatenate([lengths for _, lengths in ends])
    # In each structure on each line, where it is entered and left by the first and the second.
    order = order_along(key // 2, x)
    is_first = key[order] % 2 == 0
    pair = key[order] // (2 * len(Structure))
    # Every line crosses a ring an even number of times, so the parities may run on over all.
    in_a, in_b = np.cumsum(is_first) % 2 == 1, np.cumsum(~is_first) % 2 == 1
    steps = widths(x[order])
    shared = np.bincount(pair, weights=steps * (in_a & in_b), minlength=len(pairs))
    joint = np.bincount(pair, weights=steps * (in_a | in_b), minlength=len(pairs))
    return np.asarray(shared, dtype=np.float64), np.asarray(joint, dtype=np.float64)


@dataclass(frozen=True, eq=False)
class _Lines:
    """The common lines of pairs (k, 2) of planes: direction and origin (k, 3), mm.

    shows: (slices, structures) which slice outlines what.
    """

    pairs: Indices
    normals: Array
    direction: Array
    origin: Array
    shows: NDArray[np.bool_]

    @classmethod
    def of(cls, slices: list[PlacedSlice], pairs: Indices) -> "_Lines":
        normals = np.stack([s.plane.normal for s in slices])
        heights = np.array([s.plane.normal @ s.plane.origin for s in slices])
        a, b = pairs.T
        direction = np.cross(normals[a], normals[b])
        direction /= np.linalg.norm(direction, axis=1, keepdims=True)
        system = np.stack([normals[a], normals[b], direction], axis=1)
        right = np.stack([heights[a], heights[b], np.zeros(len(pairs))], axis=1)
        shown = [set(s.structures) for s in slices]
        return cls(
            pairs=pairs,
            normals=normals,
            direction=direction,
            origin=np.linalg.solve(system, right[:, :, None])[:, :, 0],
            shows=np.array([[structure in s for structure in Structure] for s in shown]),
        )

    def ends(self, slice_: PlacedSlice, at: int, side: int) -> tuple[Indices, Array]:
        """Where the lines of the pairs whose one `side` is slice `at` enter and leave a structure.

        Keys (m,), of pair, structure and side, and lengths (m,), mm, along the line.
        """
        edges = edges_of([c.points_mm for c in slice_.contours])
        structure = np.array([_NUMBER[c.structure] for c in slice_.contours])[edges.ring]
        (own,) = np.nonzero(self.pairs[:, side] == at)
        keys, lengths = [], []
        for run in batches([len(structure)] * len(own), _POINTS_AT_ONCE):
            pair = own[run]
            direction, origin = self.direction[pair], self.origin[pair]
            across = np.cross(self.normals[at], direction)
            far = (edges.start @ across.T) - (across * origin).sum(axis=1)
            along = (edges.start @ direction.T) - (direction * origin).sum(axis=1)
            far_end = far[edges.following]
            spans = (far <= 0.0) != (far_end <= 0.0)
            spans &= self.shows[self.pairs[pair, 1 - side]].T[structure]
            edge, line = np.nonzero(spans)
            start, end = far[edge, line], far_end[edge, line]
            first, last = along[edge, line], along[edges.following[edge], line]
            keys.append((pair[line] * len(Structure) + structure[edge]) * 2 + side)
            lengths.append(first + start / (start - end) * (last - first))
        return np.concatenate(keys), np.concatenate(lengths)
