"""How much work a request asks for, counted in plain fits of one frame."""

from intake.support import frame_surfaces
from schemas.options import Holdout, Options
from schemas.study import ContourStudy, Frame

REFIT_COST = 0.5
"""Of a fit without one slice, which starts from the field that knew it."""


def effort(study: ContourStudy, options: Options) -> float:
    """Of all frames of an admitted study: 1 a frame, and what `holdout` and `ensemble` add."""
    frames = [frame for frame in study.frames if frame_surfaces(frame, options)]
    return sum(1.0 + options.ensemble + REFIT_COST * _left_out(frame, options) for frame in frames)


def _left_out(frame: Frame, options: Options) -> int:
    """How many slices are left out in turn: those that show a requested surface."""
    if options.holdout is Holdout.NONE:
        return 0
    wanted = set(frame_surfaces(frame, options))
    showing = sum(any(c.structure in wanted for c in one.contours) for one in frame.slices)
    return showing if showing > 1 else 0
