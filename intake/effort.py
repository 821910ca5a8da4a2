"""How much work a request asks for, counted in plain fits of one frame."""

from intake.support import frame_surfaces
from schemas.cycle_report import FEWEST_FRAMES
from schemas.options import Holdout, Options
from schemas.study import ContourStudy, Frame

REFIT_COST = 0.5
"""Of a fit without one slice, which starts from the field that knew it."""

MESHING_SHARE = 0.3
"""Of the standard fit's time: what does not depend on the steps, but on the grid."""


def effort(study: ContourStudy, options: Options) -> float:
    """Of all frames of an admitted study: 1 a frame, less for those that go on from a neighbour,
    and what `holdout` and `ensemble` add.
    """
    frames = [frame for frame in study.frames if frame_surfaces(frame, options)]
    more = sum(options.ensemble + REFIT_COST * _left_out(frame, options) for frame in frames)
    # From so many on, each is near enough in time to its neighbour to go on from it.
    if len(frames) < FEWEST_FRAMES or not options.sequence.warm_start:
        return len(frames) + more
    return 1.0 + (len(frames) - 1) * warm_cost(options) + more


def warm_cost(options: Options) -> float:
    """Of a frame that goes on from a neighbour's field: a shorter fit, and all of the meshing."""
    full, less = options, options.sequence
    fit = (
        min(1.0, less.levels / full.levels)
        * min(1.0, less.iterations_per_level / full.iterations_per_level)
        * min(1.0, less.samples_per_step / full.optimizer.samples_per_step)
    )
    return (1.0 - MESHING_SHARE) * fit + MESHING_SHARE


def _left_out(frame: Frame, options: Options) -> int:
    """How many slices are left out in turn: those that show a requested surface."""
    if options.holdout is Holdout.NONE:
        return 0
    wanted = set(frame_surfaces(frame, options))
    showing = sum(any(c.structure in wanted for c in one.contours) for one in frame.slices)
    return showing if showing > 1 else 0
