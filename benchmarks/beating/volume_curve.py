"""A cavity's volume over a cycle, in a few numbers."""

from collections.abc import Sequence
from dataclasses import dataclass

from worker.evaluation.function import shrinkage_percent


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
    return Pump(edv_ml, esv_ml, shrinkage_percent(edv_ml, esv_ml))


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
