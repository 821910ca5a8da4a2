"""One outline as a clinical file has it, before its slice and its frame are known."""

from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

from schemas.vocabulary import Structure, View


@dataclass(frozen=True, eq=False)
class FoundContour:
    """An outline in patient space.

    image: SOP instance UID of the image that it was drawn on, "" where the file does not say.
    instant: frame label that its name or its file says; None where they say nothing.
    view: of its plane, where its name or kind says; None otherwise.
    """

    structure: Structure
    closed: bool
    points_mm: NDArray[np.float64]
    """(n, 3) LPS"""
    image: str = ""
    instant: str | None = None
    view: View | None = None


def without_repeats(points_mm: NDArray[np.float64]) -> NDArray[np.float64]:
    """Points (n, 3) without those that equal the one before; the first is not before the last."""
    apart = (points_mm != np.roll(points_mm, 1, axis=0)).any(axis=1)
    return points_mm[apart]
