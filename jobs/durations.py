"""How long things take, counted: a histogram that can be kept in Redis."""

from bisect import bisect_left
from collections.abc import Mapping
from dataclasses import dataclass

BOUNDS_S = (0.1, 0.5, 1, 2.5, 5, 10, 20, 30, 60, 120, 300, 600, 1800, 3600)
"""From a mesh being written to the longest job that the limits allow; beyond is the last bucket."""


def bucket(seconds: float) -> int:
    """The first bound that the duration does not exceed, by its place; one more than there are."""
    return bisect_left(BOUNDS_S, seconds)


@dataclass(frozen=True)
class Durations:
    """How many there were in each bucket, and all of them together in seconds."""

    counts: Mapping[int, int]
    total_s: float

    def cumulative(self) -> list[tuple[str, int]]:
        """Upper bounds and how many took no longer, as Prometheus counts."""
        seen = 0
        counted = []
        for place, bound in enumerate([*map(str, BOUNDS_S), "+Inf"]):
            seen += self.counts.get(place, 0)
            counted.append((bound, seen))
        return counted
