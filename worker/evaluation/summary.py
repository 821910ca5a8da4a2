"""Many distances in a few numbers."""

import numpy as np

from schemas.measures import DistanceSummary, Histogram
from schemas.problem import InternalError, ProblemType
from worker.arrays import Scalars


def summarised(distances_mm: Scalars) -> DistanceSummary:
    """Mean, RMS, percentiles, maximum and count of (n,) distances in mm, of either sign.

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
        p50=float(np.percentile(absolute, 50.0)),
        p90=float(np.percentile(absolute, 90.0)),
        p95=float(np.percentile(absolute, 95.0)),
        max=float(absolute.max()),
        count=len(absolute),
    )


_BIN_MM, _BINS = 0.1, 50
"""Fixed, so that histograms of different subjects can be laid over each other."""


def histogram(distances_mm: Scalars) -> Histogram:
    """How (n,) distances in mm, of either sign, are spread: tenths of a millimetre, up to 5 mm."""
    # By the nearest millionth of a bin, so that 0.3 falls into the bin that begins there.
    bins = np.floor(np.round(np.abs(distances_mm) / _BIN_MM, 6)).astype(np.int64)
    counts = np.bincount(np.minimum(bins, _BINS), minlength=_BINS + 1)
    return Histogram(
        bin_width_mm=_BIN_MM, counts=counts[:_BINS].tolist(), beyond=int(counts[_BINS])
    )
