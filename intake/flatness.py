"""Do the points of a slice lie on its plane?"""

import numpy as np

from intake.placed import PlacedContour, PlacedSlice
from schemas.problem import InputError, ProblemType


def check_flatness(slice_: PlacedSlice, extent_mm: float) -> None:
    """Refuse points off the slice's plane.

    They may be off by 1 mm (1 % of the study's extent, for hearts under 100 mm), or by 2 % of the
    contour's own extent if that is more.

    Raises:
        InputError: `OFF_PLANE_POINTS` at the worst point of the first contour at fault.
    """
    for contour in slice_.contours:
        off = np.abs(slice_.plane.signed_distance(contour.points_mm))
        own = float(np.linalg.norm(np.ptp(contour.points_mm, axis=0)))
        tolerance = max(min(1.0, 0.01 * extent_mm), 0.02 * own)
        # Rounded, so that of points equally far off the first is named on every machine.
        worst = int(np.argmax(off.round(6)))
        if off[worst] > tolerance:
            raise InputError(
                ProblemType.OFF_PLANE_POINTS,
                f"Slice {slice_.id}: {int((off > tolerance).sum())} of {len(off)} points of a "
                f"{contour.structure} contour lie off the slice's plane, this one by "
                f"{off[worst]:.3g} mm ({tolerance:.2g} mm is allowed). {_remedy(slice_, contour)}",
                pointer=f"{contour.pointer}/points/{worst}",
            )


def _remedy(slice_: PlacedSlice, contour: PlacedContour) -> str:
    if not slice_.plane_given:
        return (
            "Remedy: correct the point, or send contours of different planes as different slices."
        )
    centred = contour.points_mm - contour.points_mm.mean(axis=0)
    if np.abs(centred @ slice_.plane.normal).max() <= 0.02 * np.abs(centred).max():
        return (
            "The contour is parallel to the plane: `origin` is another slice's, or in other axes "
            "than the points. Remedy: correct it, or leave out `origin` and `normal`."
        )
    return (
        "Remedy: give the plane's true normal (the cross product of the image's row and column "
        "directions) in the axes of the points, or leave out `origin` and `normal`."
    )
