"""Many distances in five numbers."""

import numpy as np

from schemas.problem import InternalError, ProblemType
from schemas.report import DistanceSummary
from worker.arrays import Scalars


def summarised(distances_mm: Scalars) -> DistanceSummary:
    """Mean, RMS, 95th percentile, maximum and count of (n,) distances in mm, of either sign.

    Raises InternalError for no distances at all: there is no mean of nothing.
    """
    if not len(distances_mm):
        raise InternalError(
            ProblemType.INTERNAL, "No distances to summarise; measure at least one point."
        )
    absolute = np.abs(distances_mm)
    return DistanceSummary(
        mean=float(absolute.mean()),
        rms=float(np.sqrt(np.mean(absolute**2))),
        p95=float(np.percentile(absolute, 95.0)),
        max=float(absolute.max()),
        count=len(absolute),
    )
