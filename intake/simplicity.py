"""Does a contour cross itself?"""

import numpy as np
from numpy.typing import NDArray

from intake.even_odd import following
from intake.measured_outline import Outline
from intake.placed import PlacedSlice
from schemas.problem import InputError, ProblemType

Array = NDArray[np.float64]

CROSSED_SHARE = 0.02
"""Share of a contour's area that a fold may hold: a slip of the pen, no figure of eight."""

_SPECK = 0.01
"""Side over study extent of a square as small as a fold that never matters: in the sliver of a
cavity that a slice just grazes, the noise of the outline alone makes larger shares."""

_LOOPS = 32
"""Crossings looked at, those farthest apart along the outline first."""


def check_simple(slice_: PlacedSlice, outline: Outline, extent_mm: float) -> list[str]:
    """A warning when a contour crosses itself slightly, in a study of this extent.

    Raises:
        InputError: `SELF_CROSSING_CONTOUR` when a fold holds more than 2 % of the area;
            `TOO_LARGE` when the outline is too tangled to be searched.
    """
    contour, ring, filled_mm2 = outline.contour, outline.ring, outline.filled_mm2
    if outline.crossing is None:
        raise InputError(
            ProblemType.TOO_LARGE,
            f"Slice {slice_.id}: a {contour.structure} contour is too tangled to be checked. "
            "Remedy: send a simple outline of 100 to 300 points.",
            pointer=contour.pointer,
            status=413,
        )
    wound = abs(shoelace_mm2(ring))
    edges = np.stack(outline.crossing, axis=1)
    share, at = _largest_loop(ring, edges, filled_mm2)
    if contour.closed:
        # Crossing at a shared point shows in no edge; but winding and even-odd areas then differ.
        share = max(share, abs(filled_mm2 - wound) / max(filled_mm2, wound, 1e-300))
    folded_mm2 = share * max(filled_mm2, wound)
    if share > CROSSED_SHARE and folded_mm2 > (_SPECK * extent_mm) ** 2:
        where, place = "", contour.pointer
        if at is not None:
            i, j = (int(outline.index[k]) for k in at)
            where = f" (the edges after points {i} and {j})"
            place = f"{contour.pointer}/points/{i}"
        raise InputError(
            ProblemType.SELF_CROSSING_CONTOUR,
            f"Slice {slice_.id}: a {contour.structure} contour crosses itself{where}. "
            "Remedy: send the points in order along the outline, one contour for each closed part.",
            pointer=place,
        )
    if len(edges):
        return [
            f"Slice {slice_.id}: a {contour.structure} contour crosses itself slightly "
            f"({100 * share:.1g} % of its area); the even-odd rule decides what is inside."
        ]
    return []


def _largest_loop(
    ring: Array, edges: NDArray[np.intp], filled: float
) -> tuple[float, tuple[int, int] | None]:
    """Share of the area in the largest loop that a crossing cuts off, and that crossing."""
    largest, at = 0.0, None
    farthest = np.argsort(edges[:, 0] - edges[:, 1], kind="stable")[:_LOOPS]
    for i, j in edges[farthest]:
        loop = abs(shoelace_mm2(ring[i + 1 : j + 1]))
        rest = abs(shoelace_mm2(np.delete(ring, np.s_[i + 1 : j + 1], axis=0)))
        share = min(loop, rest) / max(filled, loop, rest, 1e-300)
        if at is None or share > largest:
            largest, at = share, (int(i), int(j))
    return largest, at


def shoelace_mm2(ring: Array) -> float:
    """Signed area of a ring (n, 2): each part counts as often as the outline winds around it."""
    x, y = (ring - ring[:1]).T
    return 0.5 * float(x @ following(y) - y @ following(x))
