"""Do slices that cross agree along the lines they share?"""

from collections.abc import Iterator
from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

from intake.even_odd import crossings_of_axis, widths
from intake.placed import PlacedFrame, PlacedSlice
from intake.planes import cross
from schemas.problem import InputError, ProblemType
from schemas.vocabulary import Structure

Array = NDArray[np.float64]

REFUSED_BELOW, NOTED_BELOW = 0.4, 0.8
"""Shared over joint length of the structures along all lines. Hearts whose slices were shifted by
3 mm reach 0.92; long-axis views in other axes than the short-axis stack 0.2 to 0.5."""

_CROSSING_COSINE = float(np.cos(np.deg2rad(20.0)))

_PAIRS = 200
"""Pairs of slices looked at in a frame, evenly chosen when there are more."""


@dataclass
class _Tally:
    """Lengths, mm, over the lines of one slice or of a frame."""

    shared: float = 0.0
    joint: float = 0.0

    def add(self, shared: float, joint: float) -> None:
        self.shared += shared
        self.joint += joint

    @property
    def likeness(self) -> float:
        return self.shared / self.joint if self.joint else 1.0


def check_intersections(frame: PlacedFrame, extent_mm: float) -> list[str]:
    """A warning when crossing slices agree badly.

    Raises:
        InputError: `CONTRADICTING_SLICES` when they do not agree at all.
    """
    outlined = [s for s in frame.slices if s.contours]
    pairs = _crossing_pairs(outlined)
    whole, of_slice = _Tally(), {s.id: _Tally() for s in outlined}
    for a, b in pairs[:: 1 + len(pairs) // _PAIRS]:
        both = [structure for structure in a.structures if structure in b.structures]
        for shared, joint in _along_line(a, b, both):
            for tally in (whole, of_slice[a.id], of_slice[b.id]):
                tally.add(shared, joint)
    if whole.likeness >= NOTED_BELOW or whole.joint < 0.5 * extent_mm:
        return []
    worst = max(outlined, key=lambda s: of_slice[s.id].joint - of_slice[s.id].shared)
    said = (
        f"Frame {frame.label}: along the lines where slices cross, their contours share only "
        f"{100 * whole.likeness:.0f} %; slice {worst.id} disagrees most"
    )
    if whole.likeness >= REFUSED_BELOW:
        return [f"{said}. Check that its plane is right and that it is of the same instant."]
    raise InputError(
        ProblemType.CONTRADICTING_SLICES,
        f"{said}. Remedy: give all slices in the same axes (LPS or RAS) and units, of one subject "
        "at one instant, each with its own plane.",
        pointer=worst.pointer,
    )


def _crossing_pairs(slices: list[PlacedSlice]) -> list[tuple[PlacedSlice, PlacedSlice]]:
    if not slices:
        return []
    normals = np.stack([s.plane.normal for s in slices])
    steep = np.triu(np.abs(normals @ normals.T) < _CROSSING_COSINE)
    return [(slices[i], slices[j]) for i, j in np.argwhere(steep)]


def _along_line(
    a: PlacedSlice, b: PlacedSlice, structures: list[Structure]
) -> Iterator[tuple[float, float]]:
    """Length of the planes' common line inside each structure on both slices, and on either, mm."""
    direction = cross(a.plane.normal, b.plane.normal)
    direction /= np.linalg.norm(direction)
    normals = np.stack([a.plane.normal, b.plane.normal, direction])
    heights = np.array([s.plane.normal @ s.plane.origin for s in (a, b)] + [0.0])
    origin = np.linalg.solve(normals, heights)
    axes = [np.stack([direction, cross(s.plane.normal, direction)], axis=1) for s in (a, b)]
    for structure in structures:
        # Where the line enters and leaves the structure, as lengths along it, mm.
        in_a, in_b = (
            crossings_of_axis([(c.points_mm - origin) @ of_s for c in s.of(structure)])
            for s, of_s in zip((a, b), axes, strict=True)
        )
        yield _shared_and_joint(in_a, in_b)


def _shared_and_joint(in_a: Array, in_b: Array) -> tuple[float, float]:
    """Lengths inside both, and either, of two sets of intervals, given by their ends."""
    ends = np.concatenate([in_a, in_b])
    order = np.argsort(ends, kind="stable")
    first = order < len(in_a)
    steps = widths(ends[order])
    inside_a, inside_b = np.cumsum(first) % 2 == 1, np.cumsum(~first) % 2 == 1
    return float(steps[inside_a & inside_b].sum()), float(steps[inside_a | inside_b].sum())
