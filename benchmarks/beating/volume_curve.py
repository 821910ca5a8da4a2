"""A cavity's volume over a cycle, in a few numbers."""

from collections.abc import Sequence
from dataclasses import dataclass

import numpy as np


@dataclass(frozen=True)
class Pump:
    """Largest and smallest volume, and the difference over the largest."""

    edv_ml: float
    esv_ml: float
    ejection_fraction_percent: float


def pump(volumes_ml: Sequence[float | None]) -> Pump | None:
    """Of the frames that have a volume; None where none has."""
    there = known(volumes_ml)
    if not there:
        return None
    edv_ml, esv_ml = max(there), min(there)
    return Pump(edv_ml, esv_ml, 100.0 * (edv_ml - esv_ml) / edv_ml)


def jitter_ml(volumes_ml: Sequence[float | None], *, is_whole_cycle: bool = True) -> float | None:
    """Root mean square of the second differences over the square root of 6, which independent
    errors of 1 mL have: an upper bound of frame-to-frame errors, as the beat bends the curve too.

    None where a frame has no volume, or where there are fewer than three. Of a whole cycle the
    first frame comes after the last one again.
    """
    there = known(volumes_ml)
    if len(there) < len(volumes_ml) or len(there) < 3:
        return None
    around = [there[-1], *there, there[0]] if is_whole_cycle else there
    return float(np.sqrt((np.diff(around, 2) ** 2).mean() / 6.0))


def differences_ml(
    volumes_ml: Sequence[float | None], others_ml: Sequence[float | None]
) -> list[float | None]:
    """Frame by frame; None where one of the two has none."""
    return [
        None if one is None or other is None else one - other
        for one, other in zip(volumes_ml, others_ml, strict=True)
    ]


def ef_error_points(
    found_ml: Sequence[float | None], true_ml: Sequence[float | None]
) -> float | None:
    """How far an ejection fraction is from the true one, in percentage points."""
    found, true = pump(found_ml), pump(true_ml)
    if found is None or true is None:
        return None
    return found.ejection_fraction_percent - true.ejection_fraction_percent


def known(values: Sequence[float | None]) -> list[float]:
    """Without the gaps."""
    return [value for value in values if value is not None]
