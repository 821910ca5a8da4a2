"""How much a number has changed since one of the frames."""

from collections.abc import Sequence


def change_percent(series: Sequence[float | None], since: int) -> list[float | None]:
    """Change of a measure from its value at frame `since`, percent of that: 0 there.

    None where the measure is, and everywhere where it is None or 0 at `since`.
    """
    first = series[since]
    if not first:
        return [None] * len(series)
    return [None if one is None else 100.0 * (one - first) / first for one in series]


def shortening_percent(series: Sequence[float | None], since: int) -> list[float | None]:
    """The same of what gets smaller, as a positive number."""
    return [None if one is None else 0.0 - one for one in change_percent(series, since)]
