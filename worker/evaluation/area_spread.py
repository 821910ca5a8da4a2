"""A number at every point of a surface in a few: its mean and how it is spread, by area."""

from dataclasses import dataclass

import numpy as np

from worker.arrays import Scalars


@dataclass(frozen=True)
class AreaSpread:
    """Mean, and the values below which 5, 50 and 95 percent of the area lie."""

    mean: float
    p5: float
    p50: float
    p95: float


def area_spread(areas_mm2: Scalars, values: Scalars) -> AreaSpread:
    """How `values` (n,) are spread over points that `areas_mm2` (n,) lie about, some positive.

    A percentile is the least value for which that share of the area has it or less: to cut a point
    into two of half its area changes nothing, nor does a point without any.
    """
    counts = areas_mm2 > 0.0
    areas, known = areas_mm2[counts], values[counts]
    low, middle, high = np.quantile(known, [0.05, 0.5, 0.95], method="inverted_cdf", weights=areas)
    return AreaSpread(float(areas @ known / areas.sum()), float(low), float(middle), float(high))
