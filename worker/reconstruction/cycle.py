"""In which order the frames of a cycle are fitted, and which one each goes on from.

One frame is fitted from nothing; from it two chains go forward and backward in time, and meet
half-way round where the cycle is whole. So no frame is far down a chain, and two processes may take
one chain each.
"""

from collections.abc import Sequence
from dataclasses import dataclass
from itertools import pairwise

from worker.reconstruction.slice_stack import SliceStack


@dataclass(frozen=True)
class FitStep:
    """One frame's turn. before: those that lead to it, the nearest first; none for the first."""

    frame: int
    before: tuple[int, ...]


def fit_order(first: int, count: int, *, whole_cycle: bool) -> tuple[FitStep, ...]:
    """Steps for frames 0 to count - 1, in time: `first`, then forward, then backward from it."""
    if whole_cycle:
        forward = [(first + k) % count for k in range(1, (count - 1) // 2 + (count - 1) % 2 + 1)]
        backward = [(first - k) % count for k in range(1, (count - 1) // 2 + 1)]
    else:
        forward, backward = list(range(first + 1, count)), list(range(first - 1, -1, -1))
    return (FitStep(first, ()), *_chain(first, forward), *_chain(first, backward))


def chains(steps: Sequence[FitStep]) -> list[tuple[FitStep, ...]]:
    """Steps in groups that do not need each other once those before each first one are taken."""
    found: list[list[FitStep]] = []
    for step in steps:
        if found and step.before and step.before[0] == found[-1][-1].frame:
            found[-1].append(step)
        else:
            found.append([step])
    return [tuple(one) for one in found]


def in_time(times_ms: Sequence[float | None]) -> list[int]:
    """Indices of frames in the order of time; as they come where one has no time."""
    order = list(range(len(times_ms)))
    known = [time for time in times_ms if time is not None]
    return order if len(known) < len(times_ms) else sorted(order, key=known.__getitem__)


def after_largest_gap(places: Sequence[int], count: int) -> int:
    """Index of the frame that comes after the longest run of missing ones, round a cycle of `count`
    places of which `places`, rising, are there; 0 where no run is longer than the one before it.
    """
    gaps = [b - a for a, b in pairwise([places[-1] - count, *places])]
    return gaps.index(max(gaps))


def observed_area(stack: SliceStack) -> float:
    """Area, mm2, that all outlines of a frame enclose: the largest is nearest to end-diastole."""
    return sum(
        outline.area_mm2
        for slice_ in stack.slices
        for outlines in slice_.outlines.values()
        for outline in outlines
    )


def _chain(first: int, frames: Sequence[int]) -> list[FitStep]:
    passed = (first, *frames)
    return [FitStep(frame, passed[place::-1]) for place, frame in enumerate(frames)]
