"""Labelled points: where the field is told what it should say."""

from collections.abc import Sequence
from dataclasses import dataclass

import numpy as np
from jaxtyping import Bool, Float, Int

from worker.arrays import Points

NO_SLICE = -1
"""Slice index of a sample that belongs to no slice and so does not move with one."""


BOUNDARY = 0.5
"""Occupancy of a sample on a surface's own contour."""


@dataclass(frozen=True, eq=False)
class LabelledSamples:
    """Points in unit coordinates with their occupancy of every surface.

    targets: 1 inside, 0 outside, 0.5 on the boundary of the surface (Eq. 1 of the paper).
    known: whether anything is known of that surface there; unknown entries carry no loss.
    slice_index: the slice each point was drawn on, or NO_SLICE.
    """

    points_unit: Points
    targets: Float[np.ndarray, "n surfaces"]
    known: Bool[np.ndarray, "n surfaces"]
    slice_index: Int[np.ndarray, " n"]


def joined(parts: Sequence[LabelledSamples]) -> LabelledSamples:
    """All samples of `parts`, in order."""
    return LabelledSamples(
        np.concatenate([p.points_unit for p in parts]),
        np.concatenate([p.targets for p in parts]),
        np.concatenate([p.known for p in parts]),
        np.concatenate([p.slice_index for p in parts]),
    )
