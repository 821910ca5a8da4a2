"""Does each contour enclose an area?"""

import math
from collections.abc import Sequence

import numpy as np
from numpy.typing import NDArray

from intake.measured_outline import LEAST_POINTS, Outline
from intake.placed import PlacedContour, PlacedSlice
from intake.planes import COLLINEAR
from intake.simplicity import check_simple, shoelace_mm2
from schemas.problem import InputError, ProblemType

Array = NDArray[np.float64]


def check_outlines(slice_: PlacedSlice, outlines: Sequence[Outline], extent_mm: float) -> list[str]:
    """Warnings about the contours of a slice, each judged alone, in a study of this extent.

    Raises:
        InputError: `DEGENERATE_CONTOUR`, `UNCLOSED_CONTOUR` or `SELF_CROSSING_CONTOUR`.
    """
    warnings = []
    for one in outlines:
        _check_extent(slice_, one.contour, one.ring)
        _check_area(slice_, one.contour, one.ring, one.filled_mm2)
        if one.contour.closed:
            _check_closed(slice_, one.contour, one.ring)
        warnings += check_simple(slice_, one, extent_mm)
    return warnings


def _check_extent(slice_: PlacedSlice, contour: PlacedContour, ring: Array) -> None:
    if len(ring) < LEAST_POINTS:
        what = f"has {len(ring)} distinct points" if len(ring) > 1 else "is a single point"
        _refuse_degenerate(slice_, contour, what)
    centred = ring - ring.mean(axis=0)
    centred /= np.abs(centred).max() or 1.0  # squares of tiny numbers would vanish
    # The singular values of the ring, from the two by two matrix of its second moments.
    (xx, xy), (_, yy) = (centred.T @ centred).tolist()
    middle, apart = 0.5 * (xx + yy), math.hypot(0.5 * (xx - yy), xy)
    if middle - apart <= COLLINEAR**2 * (middle + apart):
        _refuse_degenerate(slice_, contour, "lies on one line")


def _refuse_degenerate(slice_: PlacedSlice, contour: PlacedContour, what: str) -> None:
    raise InputError(
        ProblemType.DEGENERATE_CONTOUR,
        f"Slice {slice_.id}: a {contour.structure} contour {what} and encloses no area. "
        "Remedy: send the whole outline, or leave the contour out.",
        pointer=contour.pointer,
    )


def _check_area(
    slice_: PlacedSlice, contour: PlacedContour, ring: Array, filled_mm2: float
) -> None:
    # Either area alone can vanish: the even-odd one when wound twice, the other in an eight.
    area = max(filled_mm2, abs(shoelace_mm2(ring)))
    if area <= 1e-4 * float((np.ptp(ring, axis=0) ** 2).sum()):
        _refuse_degenerate(slice_, contour, "goes there and back along the same line")


def _check_closed(slice_: PlacedSlice, contour: PlacedContour, ring: Array) -> None:
    """A gap is suspect only beside the longest other step: hand-placed points are uneven."""
    steps = np.linalg.norm(np.diff(ring, axis=0), axis=1)
    gap = float(np.linalg.norm(ring[0] - ring[-1]))
    if gap > 3.0 * steps.max() and gap > 0.05 * (steps.sum() + gap):
        raise InputError(
            ProblemType.UNCLOSED_CONTOUR,
            f"Slice {slice_.id}: a {contour.structure} contour is said to be closed, but its ends "
            f"are {gap:.3g} mm apart and its points at most {steps.max():.3g} mm. Remedy: set "
            "`closed` to false if it ends at a valve or is cut off, or send the missing points.",
            pointer=contour.pointer,
        )
