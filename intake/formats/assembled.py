"""Contours of clinical files put together to a study: instants become frames, planes slices."""

from collections.abc import Sequence

import numpy as np

from intake.formats.clinical_faults import too_large, unusable
from intake.formats.found_contour import FoundContour
from intake.formats.found_planes import FoundPlane, found_planes
from intake.formats.image_geometry import Images
from intake.formats.imported import ImportedStudy
from intake.formats.instants import Instant, check_one_image_a_plane, instants
from intake.limits import Limits
from schemas.study import Contour, ContourStudy, Frame, Point, Slice
from schemas.vocabulary import Axes, Units

_FARTHEST_MM = 1e7
"""As of the study's coordinates."""


def assembled(
    contours: Sequence[FoundContour],
    images: Images,
    warnings: Sequence[str],
    *,
    subject_id: str,
    limits: Limits,
) -> ImportedStudy:
    """The study of `contours`, LPS mm; `warnings` are those so far.

    A plane without a contour in a frame is left out of it: nothing is known to be absent there.

    Raises:
        InputError: more than `limits`; contours whose place, plane or instant cannot be told.
    """
    check_counts([len(c.points_mm) for c in contours], limits)
    if not all(np.abs(c.points_mm).max() <= _FARTHEST_MM for c in contours):
        raise unusable(
            "a contour lies kilometres away", "send it with the geometry of the image it is on"
        )
    moments, of_time = instants(contours, images)
    kept = [contour for moment in moments for contour in moment.contours]
    planes, of_views = found_planes(kept, images)
    plane_of = {i: number for number, plane in enumerate(planes) for i in plane.contours}
    frames, first = [], 0
    for moment in moments:
        here = [plane_of[first + i] for i in range(len(moment.contours))]
        check_one_image_a_plane(moment, here)
        frames.append(_frame(moment, here, planes))
        first += len(here)
    study = ContourStudy(subject_id=subject_id, units=Units.MM, axes=Axes.LPS, frames=frames)
    return ImportedStudy(study, (*warnings, *of_time, *of_views))


def check_counts(points: Sequence[int], limits: Limits) -> None:
    """Refuse more contours, or more points, than a study may have; `points` of each contour."""
    bounds = (
        (len(points), limits.max_contours, "contours of the ventricles"),
        (max(points, default=0), limits.max_points_per_contour, "points in one contour"),
        (sum(points), limits.max_points, "points in contours of the ventricles"),
    )
    for found, most, what in bounds:
        if found > most:
            raise too_large(
                None,
                f"The files hold {found} {what}; at most {most} are accepted",
                "export fewer frames, or fewer points a contour",
            )


def _frame(moment: Instant, here: Sequence[int], planes: Sequence[FoundPlane]) -> Frame:
    on: dict[int, list[Contour]] = {}
    for contour, plane in zip(moment.contours, here, strict=True):
        on.setdefault(plane, []).append(_contour(contour))
    return Frame(
        label=moment.label,
        time_ms=moment.time_ms,
        slices=[
            Slice(
                id=planes[number].id,
                view=planes[number].view,
                origin=_point(planes[number].plane.origin),
                normal=_point(planes[number].plane.normal),
                contours=on[number],
            )
            for number in sorted(on)
        ],
    )


def _contour(found: FoundContour) -> Contour:
    points: list[Point] = [(x, y, z) for x, y, z in found.points_mm.tolist()]
    return Contour(structure=found.structure, closed=found.closed, points=points)


def _point(vector: np.ndarray) -> Point:
    x, y, z = vector.tolist()
    return (x, y, z)
