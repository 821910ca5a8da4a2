"""Going from 0 to 1 between two places, smoothly."""

import numpy as np

from worker.arrays import Scalars


def smooth_step(at: Scalars, start: float, end: float) -> tuple[Scalars, Scalars]:
    """0 up to `start`, 1 from `end` on, and between them 6x^5 - 15x^4 + 10x^3; with its slope.

    Twice continuously differentiable; one half in the middle.
    """
    x = np.clip((at - start) / (end - start), 0.0, 1.0)
    value: Scalars = x**3 * (10.0 + x * (6.0 * x - 15.0))
    slope: Scalars = 30.0 * (x * (1.0 - x)) ** 2 / (end - start)
    return value, slope
