"""Joining two solids with a rounded edge."""

import numpy as np

from worker.arrays import Scalars


def rounded_intersection(first_mm: Scalars, second_mm: Scalars, radius_mm: float) -> Scalars:
    """Signed length to the intersection of two solids, its edge rounded over about `radius_mm`.

    A quadratic smooth maximum: never below the larger of the two, so the result lies in both.
    """
    overlap = np.maximum(radius_mm - np.abs(first_mm - second_mm), 0.0)
    rounded: Scalars = np.maximum(first_mm, second_mm) + overlap**2 / (4.0 * radius_mm)
    return rounded
