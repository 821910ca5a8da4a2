"""From a frame of the wire model to a stack of slices in mm."""

import numpy as np

from intake.planes import slice_plane
from schemas.study import Contour, ContourStudy, Frame, Slice
from schemas.vocabulary import Structure
from worker.arrays import Points
from worker.reconstruction.slice_stack import Outline, SliceStack, StackSlice


def build_stack(study: ContourStudy, frame: Frame) -> SliceStack:
    """The slices of `frame` in mm, every outline dropped perpendicularly onto its slice's plane.

    Expects an admitted study (`intake.study.admit`).
    """
    scale = study.units.millimetres
    return SliceStack(
        label=frame.label,
        time_ms=frame.time_ms,
        slices=tuple(_build_slice(s, scale) for s in frame.slices),
    )


def _build_slice(slice_: Slice, scale: float) -> StackSlice:
    plane = slice_plane(slice_, scale)
    outlines: dict[Structure, list[Outline]] = {}
    for contour in slice_.contours:
        points_mm = _points_mm(contour, scale)
        off = (points_mm - plane.origin) @ plane.normal
        flat = points_mm - off[:, None] * plane.normal
        outlines.setdefault(contour.structure, []).append(Outline(flat, contour.closed))
    return StackSlice(
        id=slice_.id,
        view=slice_.view,
        origin_mm=plane.origin,
        normal=plane.normal,
        outlines={s: tuple(o) for s, o in outlines.items()},
        absent=frozenset(slice_.absent),
    )


def _points_mm(contour: Contour, scale: float) -> Points:
    """Contour points without consecutive repeats; of a closed one, the closing one included."""
    points = np.asarray(contour.points, dtype=np.float64) * scale
    keep = np.any(points != np.roll(points, -1, axis=0), axis=1)
    keep[-1] |= not contour.closed
    return points[keep]
