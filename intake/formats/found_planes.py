"""The planes that contours lie in, which of them are the short-axis stack, and their names."""

from collections.abc import Sequence
from dataclasses import dataclass, field

import numpy as np

from intake.formats.clinical_faults import unusable
from intake.formats.found_contour import FoundContour
from intake.formats.image_geometry import Images
from intake.formats.long_axis_views import LEFT, RIGHT, long_axis_view, towards_right
from intake.planes import Plane, fit_plane
from schemas.problem import InputError
from schemas.vocabulary import View

SAME_PLANE_MM = 0.5
"""Contours whose points are all this near to a plane lie in it."""

_PARALLEL = np.cos(np.radians(3.0))
_AXIAL = np.cos(np.radians(10.0))
_LEAST_STACK = 3

MAX_PLANES = 512


@dataclass(eq=False)
class FoundPlane:
    """A plane and the contours in it, by their place in the list they came in."""

    plane: Plane
    contours: list[int] = field(default_factory=list)
    view: View = View.OTHER
    id: str = ""


def found_planes(
    contours: Sequence[FoundContour], images: Images
) -> tuple[list[FoundPlane], list[str]]:
    """The planes of all contours, named, in the order of their ids; and what was not sure of them.

    The plane of a contour is its image's, where that is known, else the one fitted to it. Views
    are those that contours or images name; where no stack is named, three parallel planes or more
    are the short-axis stack unless they are axial, and planes across it are of the long-axis view
    that the right ventricle's side tells, or of none.

    Raises:
        InputError: a contour on one line, and no image to tell its plane; too many planes.
    """
    planes: list[FoundPlane] = []
    sizes = [float(np.linalg.norm(np.ptp(c.points_mm, axis=0))) for c in contours]
    for index in sorted(range(len(contours)), key=lambda i: -sizes[i]):
        _take_in(planes, contours, index, images)
    for found in planes:
        told = {view for i in found.contours if (view := _view_told(contours[i], images))}
        if len(told) == 1:
            found.view = told.pop()
    warnings = [*_tell_stack(planes), *_tell_long_axis(planes, contours)]
    return _named(planes), warnings


def _view_told(contour: FoundContour, images: Images) -> View | None:
    """The contour's own name goes before its image's series."""
    if contour.view is not None or contour.image not in images:
        return contour.view
    return images[contour.image].view


def _take_in(
    planes: list[FoundPlane], contours: Sequence[FoundContour], index: int, images: Images
) -> None:
    points = contours[index].points_mm
    centre = points.mean(axis=0)
    for found in planes:
        # The centre first: it is quick to rule out.
        if abs((centre - found.plane.origin) @ found.plane.normal) <= SAME_PLANE_MM and (
            np.abs(found.plane.signed_distance(points)).max() <= SAME_PLANE_MM
        ):
            found.contours.append(index)
            return
    if len(planes) >= MAX_PLANES:
        raise unusable(
            f"the contours lie in more than {MAX_PLANES} planes",
            "export contours that were drawn on image planes",
        )
    image = images.get(contours[index].image)
    if image is not None:
        plane = Plane.through(centre, image.normal)
    else:
        try:
            plane = fit_plane(points)
        except InputError as error:
            raise unusable(
                f"a {contours[index].structure} contour lies on one line, and in no other's plane",
                "send the whole outline, or leave the contour out",
            ) from error
    planes.append(FoundPlane(plane, [index]))


def _tell_stack(planes: Sequence[FoundPlane]) -> list[str]:
    """Sets the view of the stack where nothing names it; says that it did, or why not."""
    unnamed = [p for p in planes if p.view is View.OTHER]
    if not unnamed or any(p.view is View.SAX for p in planes):
        return []
    normals = np.array([p.plane.normal for p in unnamed])
    parallel = np.abs(normals @ normals.T) >= _PARALLEL
    most = int(np.argmax(parallel.sum(axis=1)))
    stack = [p for p, belongs in zip(unnamed, parallel[most], strict=True) if belongs]
    if len(stack) < _LEAST_STACK:
        return [f"No stack of parallel planes: the views of {len(unnamed)} planes are not known."]
    if abs(normals[most][2]) >= _AXIAL:
        return [
            f"{len(stack)} parallel planes lie across the body, not across the heart's axis: "
            "their view is not known."
        ]
    for found in stack:
        found.view = View.SAX
    return [f"{len(stack)} parallel planes were taken for the short-axis stack."]


def _tell_long_axis(planes: Sequence[FoundPlane], contours: Sequence[FoundContour]) -> list[str]:
    """Sets the views of planes across the stack where nothing names them; says which."""
    stack = [p for p in planes if p.view is View.SAX]
    rest = [p for p in planes if p.view is View.OTHER]
    if not stack or not rest:
        return []
    normal = stack[0].plane.normal
    here = [contours[i] for p in stack for i in p.contours]
    left, right = ([c.points_mm for c in here if c.structure in side] for side in (LEFT, RIGHT))
    direction = towards_right(left, right, normal)
    if direction is not None:
        for found in rest:
            outlined = {contours[i].structure for i in found.contours}
            found.view = long_axis_view(found.plane.normal, outlined, normal, direction)
    told = sorted({p.view.value for p in rest} - {View.OTHER.value})
    unsure = sum(p.view is View.OTHER for p in rest)
    warnings = []
    if told:
        warnings.append(
            f"{', '.join(told)}: told by where the right ventricle lies, not by a name."
        )
    if unsure:
        warnings.append(
            f"{unsure} planes beside the stack are of no known view: name it in the series "
            "description, the region's name or the geometry table."
        )
    return warnings


def _named(planes: list[FoundPlane]) -> list[FoundPlane]:
    """In order of view, then along the normal of the view's first plane; each with its id."""
    named: list[FoundPlane] = []
    for view in View:
        here = [p for p in planes if p.view is view]
        if not here:
            continue
        normal = here[0].plane.normal
        here.sort(key=lambda p: float(p.plane.origin @ normal))
        for number, found in enumerate(here):
            alone = view.is_long_axis and len(here) == 1
            found.id = view.value if alone else f"{view.value}-{number:02d}"
        named += here
    return named
