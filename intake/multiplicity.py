"""Several contours of one structure on a slice: parts and holes, or a mistake?"""

from itertools import combinations

import numpy as np

from intake.overlap import overlap
from intake.placed import PlacedContour, PlacedSlice
from schemas.problem import InputError, ProblemType

_COMPARED = 6
"""Contours of a structure compared pair by pair, the largest first; specks are let pass."""


def check_multiplicity(slice_: PlacedSlice) -> None:
    """Refuse contours of one structure that cross, or coincide and so cancel out.

    Raises:
        InputError: `SELF_CROSSING_CONTOUR` or `DEGENERATE_CONTOUR` at the later of the two.
    """
    for structure in slice_.structures:
        contours = sorted(slice_.of(structure), key=_size, reverse=True)[:_COMPARED]
        for pair in combinations(contours, 2):
            _check_pair(slice_, *sorted(pair, key=slice_.contours.index))


def _size(contour: PlacedContour) -> float:
    return float(np.ptp(contour.ring, axis=0).sum())


def _check_pair(slice_: PlacedSlice, a: PlacedContour, b: PlacedContour) -> None:
    """Two contours of a structure are apart, or one is a hole in the other."""
    if (a.ring.min(axis=0) > b.ring.max(axis=0)).any():
        return
    if (b.ring.min(axis=0) > a.ring.max(axis=0)).any():
        return
    ab, ba = overlap([a.ring], [b.ring]), overlap([b.ring], [a.ring])
    smaller = ab if ab.area_mm2 < ba.area_mm2 else ba
    share = smaller.share
    if share > 0.9 and smaller.area_mm2 > 0.9 * max(ab.area_mm2, ba.area_mm2):
        raise InputError(
            ProblemType.DEGENERATE_CONTOUR,
            f"Slice {slice_.id}: two {a.structure} contours coincide and cancel out (one within "
            "another is a hole). Remedy: remove one of them.",
            pointer=b.pointer,
        )
    if 0.1 < share < 0.9:
        raise InputError(
            ProblemType.SELF_CROSSING_CONTOUR,
            f"Slice {slice_.id}: two {a.structure} contours cross, sharing {100 * share:.0f} % of "
            "the smaller one. Remedy: join them into one outline, or keep one of them.",
            pointer=b.pointer,
        )
