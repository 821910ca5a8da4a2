"""The guide points of one slice in one frame, made contours."""

from collections.abc import Sequence
from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

from intake.formats.faults import unreadable
from intake.formats.guide_point_rows import GuidePoint
from intake.formats.guide_point_types import MARKERS, OPENINGS, PIECES, SEPTUM, view_and_kind
from intake.formats.outline_runs import runs_of
from intake.formats.slice_info import ImagePlane
from intake.formats.whole_outline import WholeOutline, whole_outline
from schemas.study import Contour, Slice
from schemas.vocabulary import Structure, View

Array = NDArray[np.float64]

_NOTED_MM = 0.1
_OFF_PLANE_MM = 5.0
_MOST_POINTS = 1000
"""Of one type on one slice: five times what any outline needs."""


@dataclass(frozen=True, eq=False)
class GuideSlice:
    """A slice of a frame. plane: None where no SliceInfo says it. name: of the file."""

    frame: str
    id: str
    view: View
    plane: ImagePlane | None
    name: str

    def contours(self, rows: Sequence[GuidePoint]) -> tuple[list[Contour], list[str]]:
        """The contours that the rows make, and warnings. Raises InputError for stray points."""
        pieces = self._pieces(rows)
        outlined = {
            structure: [pieces[kind] for kind in of.wall if kind in pieces]
            for structure, of in PIECES.items()
        }
        if not any(outlined.values()):
            return [], []
        plane = self.plane or _fitted(np.concatenate(list(pieces.values())))
        warnings = self._check_flat(rows, plane)
        flat = {kind: (p - plane.origin_mm) @ plane.directions.T for kind, p in pieces.items()}
        runs = {kind: runs_of(p) for kind, p in flat.items() if kind not in MARKERS}
        contours: list[Contour] = []
        for structure, of in PIECES.items():
            wall = [runs[kind] for kind in of.wall if kind in runs]
            if not wall:
                continue
            if structure is Structure.RV_EPI and not _has_cavity(contours):
                warnings.append(
                    f"{self._where}: the rv_epi outline has no rv_endo in it; it was left out."
                )
                continue
            valves = [flat[valve] for valve in OPENINGS[structure] if valve in flat]
            made = whole_outline(
                wall,
                runs.get(SEPTUM) if of.septum else None,
                long_axis=self.view is not View.SAX,
                valve=np.concatenate(valves) if valves else None,
            )
            warnings += self._about(structure, made)
            if made.flaw is None:
                points_mm = _canonical(
                    plane.origin_mm + made.points @ plane.directions, plane.normal, made.closed
                )
                contours.append(
                    Contour(
                        structure=structure,
                        closed=made.closed,
                        points=[(x, y, z) for x, y, z in points_mm.tolist()],
                    )
                )
        return contours, warnings

    def with_contours(self, contours: list[Contour]) -> Slice:
        if self.plane is None:
            return Slice(id=self.id, view=self.view, contours=contours)
        x, y, z = self.plane.origin_mm.tolist()
        u, v, w = self.plane.normal.tolist()
        return Slice(
            id=self.id, view=self.view, origin=(x, y, z), normal=(u, v, w), contours=contours
        )

    def _pieces(self, rows: Sequence[GuidePoint]) -> dict[str, Array]:
        """Points (n, 3), mm, by kind, whatever the view in their type."""
        points: dict[str, list[tuple[float, float, float]]] = {}
        for row in rows:
            if row.weight > 0.0:
                own = points.setdefault(view_and_kind(row.contour_type)[1], [])
                own.append(row.point_mm)
                if len(own) > _MOST_POINTS:
                    raise unreadable(
                        self.name,
                        f"more than {_MOST_POINTS} points of {row.contour_type} on slice {self.id}",
                        "resample the outline; 100 to 300 points are ample",
                        line=row.line,
                    )
        return {kind: np.array(own) for kind, own in points.items()}

    def _check_flat(self, rows: Sequence[GuidePoint], plane: ImagePlane) -> list[str]:
        off = np.abs((np.array([r.point_mm for r in rows]) - plane.origin_mm) @ plane.normal)
        worst = int(np.argmax(off))
        if off[worst] > _OFF_PLANE_MM:
            raise unreadable(
                self.name,
                f"the point is {off[worst]:.3g} mm off the plane of slice {self.id}",
                "send the SliceInfo file that belongs to these points, or correct the slice id",
                line=rows[worst].line,
            )
        if off[worst] > _NOTED_MM:
            return [
                f"{self._where}: {int((off > _NOTED_MM).sum())} points lie off the slice's plane, "
                f"by up to {off[worst]:.2g} mm; they were projected onto it."
            ]
        return []

    @property
    def _where(self) -> str:
        return f"Frame {self.frame}, slice {self.id}"

    def _about(self, structure: Structure, made: WholeOutline) -> list[str]:
        said = []
        if made.spikes:
            said.append(
                f"{self._where}: {made.spikes} points far off the line of a {structure} outline "
                "were left out."
            )
        if made.flaw is not None:
            said.append(f"{self._where}: the {structure} outline {made.flaw}; it was left out.")
        return said


def _has_cavity(contours: Sequence[Contour]) -> bool:
    return any(contour.structure is Structure.RV_ENDO for contour in contours)


def _canonical(points_mm: Array, normal: Array, closed: bool) -> Array:
    """The same outline (n, 3), to 10 nm, however it was told: from the end that sorts first.

    A closed one begins at the point that sorts first and turns about the normal.
    """
    points_mm = points_mm.round(5) + 0.0
    if not closed:
        return points_mm if tuple(points_mm[0]) <= tuple(points_mm[-1]) else points_mm[::-1]
    turned = np.cross(points_mm - points_mm[0], np.roll(points_mm, -1, axis=0) - points_mm[0])
    if float(turned.sum(axis=0) @ normal) < 0.0:
        points_mm = points_mm[::-1]
    return np.roll(points_mm, -int(np.lexsort(points_mm.T[::-1])[0]), axis=0)


def _fitted(points_mm: Array) -> ImagePlane:
    centre = points_mm.mean(axis=0)
    directions = np.linalg.svd(points_mm - centre, full_matrices=False)[2][:2]
    return ImagePlane(centre, directions)
