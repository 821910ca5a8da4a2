"""One frame of a contour study as arrays: slices in mm, in the study's own patient axes."""

from collections.abc import Mapping
from dataclasses import dataclass

import numpy as np

from schemas.vocabulary import Structure, View
from worker.arrays import Points, Vector


@dataclass(frozen=True, eq=False)
class Outline:
    """One observed outline: (n, 3) points on the slice's plane; closed if the last joins the first.

    An open outline is closed by a chord that is not an observed boundary.
    """

    points_mm: Points
    closed: bool

    @property
    def area_mm2(self) -> float:
        """What it encloses, mm2, the chord included."""
        from_first = self.points_mm - self.points_mm[0]
        twice = np.cross(from_first[:-1], from_first[1:]).sum(axis=0)
        return 0.5 * float(np.linalg.norm(twice))


@dataclass(frozen=True, eq=False)
class StackSlice:
    """One slice: its plane, what is observed on it and what is known to be absent from it.

    origin_mm, normal: (3,) each; the normal has unit length.
    """

    id: str
    view: View
    origin_mm: Vector
    normal: Vector
    outlines: Mapping[Structure, tuple[Outline, ...]]
    absent: frozenset[Structure]


@dataclass(frozen=True, eq=False)
class SliceStack:
    """All slices of one frame."""

    label: str
    time_ms: float | None
    slices: tuple[StackSlice, ...]

    @property
    def observed(self) -> frozenset[Structure]:
        """Structures with an outline somewhere."""
        return frozenset(s for slice_ in self.slices for s in slice_.outlines)

    @property
    def points_mm(self) -> Points:
        """All outline points, (n, 3)."""
        return np.concatenate(
            [o.points_mm for s in self.slices for outlines in s.outlines.values() for o in outlines]
        )
