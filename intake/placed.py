"""A contour study as arrays: every contour in millimetres, on its plane, with its JSON pointer."""

from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

from intake.planes import Plane, slice_plane
from schemas.problem import InputError
from schemas.study import Contour, ContourStudy, Slice
from schemas.vocabulary import Structure

Array = NDArray[np.float64]


@dataclass(frozen=True, eq=False)
class PlacedContour:
    """One outline; `points_mm` (n, 3) in patient axes, `ring` (n, 2) in the plane's, mm."""

    structure: Structure
    closed: bool
    points_mm: Array
    ring: Array
    pointer: str


@dataclass(frozen=True, eq=False)
class PlacedSlice:
    """One slice and its plane, given or fitted."""

    id: str
    plane: Plane
    plane_given: bool
    contours: tuple[PlacedContour, ...]
    absent: frozenset[Structure]
    pointer: str

    @property
    def structures(self) -> list[Structure]:
        """The structures observed here, in the vocabulary's order."""
        here = {c.structure for c in self.contours}
        return [s for s in Structure if s in here]

    def of(self, structure: Structure) -> list[PlacedContour]:
        return [c for c in self.contours if c.structure is structure]

    def rings(self, structure: Structure) -> list[Array]:
        return [c.ring for c in self.of(structure)]


@dataclass(frozen=True, eq=False)
class PlacedFrame:
    """One instant of the cycle."""

    label: str
    slices: tuple[PlacedSlice, ...]
    pointer: str


def place(study: ContourStudy, pointer: str) -> list[PlacedFrame]:
    """The study's contours on their planes; `pointer` is where it stands in the request.

    Raises:
        InputError: `DEGENERATE_CONTOUR` when a plane is neither given nor fixed by the points.
    """
    return [
        PlacedFrame(
            label=frame.label,
            slices=tuple(
                _place_slice(s, study.units.millimetres, f"{pointer}/frames/{i}/slices/{j}")
                for j, s in enumerate(frame.slices)
            ),
            pointer=f"{pointer}/frames/{i}",
        )
        for i, frame in enumerate(study.frames)
    ]


def _place_slice(slice_: Slice, millimetres: float, pointer: str) -> PlacedSlice:
    try:
        plane = slice_plane(slice_, millimetres)
    except InputError as error:
        at = f"{pointer}/contours/0" if len(slice_.contours) == 1 else pointer
        raise InputError(error.type, f"Slice {slice_.id}: {error.detail}", pointer=at) from error
    return PlacedSlice(
        id=slice_.id,
        plane=plane,
        plane_given=slice_.origin is not None,
        contours=tuple(
            _place_contour(c, plane, millimetres, f"{pointer}/contours/{k}")
            for k, c in enumerate(slice_.contours)
        ),
        absent=frozenset(slice_.absent),
        pointer=pointer,
    )


def _place_contour(
    contour: Contour, plane: Plane, millimetres: float, pointer: str
) -> PlacedContour:
    points_mm = np.array(contour.points, dtype=np.float64) * millimetres
    return PlacedContour(
        structure=contour.structure,
        closed=contour.closed,
        points_mm=points_mm,
        ring=plane.to_plane(points_mm),
        pointer=pointer,
    )
