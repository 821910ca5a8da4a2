"""Which frames of a cycle have the most and the least of something."""

from collections.abc import Sequence

from schemas.cycle_report import FEWEST_FRAMES


def largest_and_smallest(sizes: Sequence[float | None]) -> tuple[int, int] | None:
    """Indices of the first largest and the first smallest of positive sizes; None of fewer than
    three that are known.
    """
    known = [index for index, size in enumerate(sizes) if size]
    if len(known) < FEWEST_FRAMES:
        return None
    by_size = {index: sizes[index] or 0.0 for index in known}
    return max(known, key=by_size.__getitem__), min(known, key=by_size.__getitem__)
