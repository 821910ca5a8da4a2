"""Which planes of a frame are one and the same."""

import numpy as np
from numpy.typing import NDArray

from intake.planes import Plane

Array = NDArray[np.float64]

_SAME_ANGLE_COSINE = float(np.cos(np.deg2rad(1.0)))

_SAME_OFFSET = 0.0025
"""Distance over extent below which parallel planes are one: 0.3 mm on a human heart."""


def coincident(planes: list[Plane], centre: Array, extent: float) -> NDArray[np.bool_]:
    """Which pairs (n, n) of planes coincide over a heart at `centre` (3,) of this `extent`.

    Lengths in any one unit. Planes are compared where the heart is: their origins may be far away.
    """
    normals = np.stack([p.normal for p in planes])
    offsets = np.array([p.normal @ (centre - p.origin) for p in planes])
    cosines = normals @ normals.T
    gap = np.abs(offsets[:, None] - np.sign(cosines) * offsets[None, :])
    same: NDArray[np.bool_] = (np.abs(cosines) >= _SAME_ANGLE_COSINE) & (
        gap <= _SAME_OFFSET * extent
    )
    return same


def count_distinct(same: NDArray[np.bool_]) -> int:
    """How many distinct planes there are, given which pairs (n, n) coincide."""
    left = np.ones(len(same), dtype=np.bool_)
    count = 0
    while left.any():
        left &= ~same[int(np.argmax(left))]
        count += 1
    return count
