"""Slices in unit coordinates: each a plane with two axes, outlines as rings in that plane."""

from collections.abc import Mapping, Sequence
from dataclasses import dataclass, replace

import numpy as np
from jaxtyping import Float

from schemas.vocabulary import Structure, View
from worker.arrays import PlanePoint, PlanePoints, Points, Vector


@dataclass(frozen=True, eq=False)
class UnitOutline:
    """(n, 2) in-plane points in unit coordinates, and whether the last joins the first."""

    points: PlanePoints
    closed: bool

    @property
    def edges(self) -> tuple[PlanePoints, PlanePoints]:
        """Start and end of every observed edge; the chord of an open outline is not one."""
        ends = np.roll(self.points, -1, axis=0)
        last = None if self.closed else -1
        return self.points[:last], ends[:last]


@dataclass(frozen=True, eq=False)
class UnitSlice:
    """One slice: point = origin + a * axes[0] + b * axes[1]."""

    id: str
    view: View
    origin: Vector
    axes: Float[np.ndarray, "2 3"]
    outlines: Mapping[Structure, tuple[UnitOutline, ...]]
    absent: frozenset[Structure]

    @property
    def normal(self) -> Vector:
        """Unit normal of the plane."""
        return np.cross(self.axes[0], self.axes[1])

    @property
    def pivot(self) -> PlanePoint:
        """What the slice turns about: the middle of its outlines' points, in its plane."""
        rings = [o.points for outlines in self.outlines.values() for o in outlines]
        return np.concatenate(rings).mean(axis=0) if rings else np.zeros(2)

    def lift(self, in_plane: PlanePoints) -> Points:
        """(n, 2) in-plane coordinates to (n, 3) unit coordinates."""
        return self.origin + in_plane @ self.axes

    def drop(self, points_unit: Points) -> PlanePoints:
        """(n, 3) unit coordinates to (n, 2), along the normal."""
        return (points_unit - self.origin) @ self.axes.T


@dataclass(frozen=True, eq=False)
class UnitStack:
    """All slices of one frame in unit coordinates."""

    slices: tuple[UnitSlice, ...]

    def showing(self, structures: Sequence[Structure]) -> "UnitStack":
        """The same slices with the outlines of `structures` alone."""
        return UnitStack(
            tuple(
                replace(s, outlines={k: o for k, o in s.outlines.items() if k in structures})
                for s in self.slices
            )
        )

    @property
    def points_unit(self) -> Points:
        """All outline points, (n, 3)."""
        return np.concatenate(
            [
                s.lift(o.points)
                for s in self.slices
                for outlines in s.outlines.values()
                for o in outlines
            ]
        )
