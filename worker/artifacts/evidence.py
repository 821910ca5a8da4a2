"""What was observed of each surface, where alignment moved it to."""

from collections.abc import Mapping

from schemas.vocabulary import Structure
from worker.evaluation.support import AlignedOutline
from worker.reconstruction.result import FrameFit


def aligned_outlines(fit: FrameFit) -> Mapping[Structure, tuple[AlignedOutline, ...]]:
    """The observed outlines of every structure of a frame, moved back by their slice's shift."""
    outlines: dict[Structure, tuple[AlignedOutline, ...]] = {}
    for one in fit.slices:
        for structure, contours in one.contours_mm.items():
            outlines[structure] = outlines.get(structure, ()) + tuple(
                AlignedOutline(one.id, one.view, one.aligned_mm(c.points_mm), c.closed)
                for c in contours
            )
    return outlines
