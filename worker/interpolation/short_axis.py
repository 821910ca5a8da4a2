"""The short-axis slices that show a structure, as one stack of parallel planes."""

from dataclasses import dataclass

import numpy as np

from intake.planes import Plane
from schemas.problem import InputError, ProblemType
from schemas.vocabulary import Structure, View
from worker.arrays import Points, Scalars
from worker.reconstruction.slice_stack import SliceStack, StackSlice

_MOST_TILT_DEG = 10.0
"""Planes that lean further than this from the first cannot be taken for parallel."""
_LEAST_GAP_MM = 0.01

Rings = tuple[np.ndarray, ...]
"""The outlines of one slice, each (k, 2) mm; one within another is a hole."""


@dataclass(frozen=True, eq=False)
class ShortAxisStack:
    """Outlines by slice, from the lowest to the highest, in the frame of `base`.

    heights_mm: (n,) ascending, along the normal of `base`. rings: outlines of each slice.
    gap_mm: between slices, the median. bottom_mm, top_mm: where the structure is taken to end:
    half a gap beyond its last slice, or halfway to a nearer one that shows it to be absent.
    """

    base: Plane
    heights_mm: Scalars
    rings: tuple[Rings, ...]
    gap_mm: float
    bottom_mm: float
    top_mm: float

    @property
    def outline_points(self) -> Points:
        """All outlines, (n, 3) mm: in-plane axes and height."""
        return np.concatenate(
            [
                np.column_stack([ring, np.full(len(ring), height)])
                for height, rings in zip(self.heights_mm, self.rings, strict=True)
                for ring in rings
            ]
        )

    def to_space(self, in_plane: np.ndarray, heights_mm: np.ndarray) -> Points:
        """Patient coordinates (n, 3) mm of in-plane points (n, 2) at heights (n,)."""
        return self.base.to_space(in_plane) + heights_mm[:, None] * self.base.normal


def short_axis_stack(stack: SliceStack, structure: Structure) -> ShortAxisStack:
    """The outlines of `structure` on short-axis slices; other views are left out.

    A slice between two that show the structure, and does not, says nothing here. An open outline
    is closed by its chord.
    Raises InputError for fewer than two slices, or for slices that are not a stack.
    """
    axial = [s for s in stack.slices if s.view is View.SAX]
    showing = [s for s in axial if s.outlines.get(structure)]
    if len(showing) < 2:
        raise InputError(
            ProblemType.TOO_FEW_SLICES,
            f"{structure.value} is outlined on {len(showing)} short-axis slice(s), and between "
            "fewer than two there is nothing to interpolate; outline it on two or more.",
        )
    base = Plane.through(showing[0].origin_mm, showing[0].normal)
    for slice_ in showing:
        _require_parallel(base, slice_)
    heights = np.array([base.signed_distance(s.origin_mm[None])[0] for s in showing])
    order = np.argsort(heights)
    heights = heights[order]
    gaps = np.diff(heights)
    if gaps.min() < _LEAST_GAP_MM:
        twice = [showing[order[int(np.argmin(gaps)) + step]].id for step in (0, 1)]
        raise InputError(
            ProblemType.CONTRADICTING_SLICES,
            f"The short-axis slices {twice[0]} and {twice[1]} are one plane; leave one of them "
            "out, or merge their contours.",
        )
    empty = [base.signed_distance(s.origin_mm[None])[0] for s in axial if structure in s.absent]
    gap = float(np.median(gaps))
    below = min([gap, *(heights[0] - h for h in empty if h < heights[0])])
    above = min([gap, *(h - heights[-1] for h in empty if h > heights[-1])])
    return ShortAxisStack(
        base=base,
        heights_mm=heights,
        rings=tuple(
            tuple(base.to_plane(o.points_mm) for o in showing[i].outlines[structure]) for i in order
        ),
        gap_mm=gap,
        bottom_mm=float(heights[0] - below / 2.0),
        top_mm=float(heights[-1] + above / 2.0),
    )


def _require_parallel(base: Plane, slice_: StackSlice) -> None:
    leaning = float(np.degrees(np.arccos(min(1.0, abs(base.normal @ slice_.normal)))))
    if leaning > _MOST_TILT_DEG:
        raise InputError(
            ProblemType.CONTRADICTING_SLICES,
            f"The short-axis slice {slice_.id} leans {leaning:.0f} degrees from the others, and "
            "this method knows parallel planes only; correct its view or its normal, or use a "
            "method that takes planes at any angle.",
        )
