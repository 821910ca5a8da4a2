"""Where a short-axis stack is taken to end, when no long-axis slice shows it."""

import numpy as np

from schemas.vocabulary import View
from worker.arrays import Points
from worker.reconstruction.unit_stack import UnitStack


def past_the_ends(stack: UnitStack, inflation: float) -> Points:
    """Outlines of a short-axis stack's end slices, moved outward; (n, 3) unit.

    Inflated by `inflation` about the centroid of all outlines, they lie one slice gap beyond the
    stack: for all that is known, what the last slice shows ends halfway to where the next would
    have been. Empty where long-axis slices show the ends, and for fewer than two slices.
    """
    showing = [s for s in stack.slices if s.view is View.SAX and s.outlines]
    if len(showing) < 2 or any(s.view.is_long_axis and s.outlines for s in stack.slices):
        return np.empty((0, 3))
    normal = showing[0].normal
    middle = float(stack.points_unit.mean(axis=0) @ normal)
    showing.sort(key=lambda s: float(s.origin @ normal))
    heights = np.array([s.origin @ normal for s in showing]) - middle
    gap = float(np.median(np.diff(heights)))
    moved = []
    for slice_, height in ((showing[0], heights[0]), (showing[-1], heights[-1])):
        beyond = abs(height) + gap
        step = np.sign(height) * max(beyond / inflation - abs(height), 0.0)
        moved += [
            slice_.lift(outline.points) + step * normal
            for outlines in slice_.outlines.values()
            for outline in outlines
        ]
    return np.concatenate(moved)
