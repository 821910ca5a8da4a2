"""How unsteady a number is from frame to frame."""

from collections.abc import Sequence

import numpy as np

_OF_INDEPENDENT_ERRORS = 6.0
"""Mean square second difference of independent errors of variance 1: 1 + 4 + 1."""


def jitter(series: Sequence[float | None], *, is_whole_cycle: bool) -> float | None:
    """Root mean square second difference of a series over that of independent errors of size 1, in
    the unit of the series: errors from frame to frame are no larger than this, for a series that
    truly bends has second differences of its own.

    The frames are taken as evenly spaced. None where no three of them follow on each other.
    """
    values = np.array([np.nan if one is None else one for one in series])
    if is_whole_cycle and len(values) > 2:
        values = np.concatenate([values[-1:], values, values[:1]])
    bends = np.diff(values, 2)
    known = bends[np.isfinite(bends)]
    return float(np.sqrt((known**2).mean() / _OF_INDEPENDENT_ERRORS)) if len(known) else None
