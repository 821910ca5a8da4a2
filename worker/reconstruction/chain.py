"""Frames fitted one after another, each from those before it; one that fails fails alone.

A part of the pipeline: it joins stages that do not know each other.
"""

from collections.abc import Iterator, Sequence
from contextlib import contextmanager
from dataclasses import dataclass, field

from schemas.problem import InputError, InternalError, ProblemType, ServiceError
from worker.checkpoints import Checkpoint, Checkpoints
from worker.observer import Cancelled, Observer
from worker.reconstruction.cycle import FitStep
from worker.reconstruction.frame_pipeline import reconstruct_frame
from worker.reconstruction.frame_share import FrameShare
from worker.reconstruction.result import FrameFit
from worker.reconstruction.sequence import FrameSequence

_OF_A_FRAME = (ProblemType.NO_SURFACE, ProblemType.INTERNAL)
"""Failures of ours that other frames of the study may well not share."""


@dataclass
class FrameResults:
    """By the frame's index, what was found of it or what was wrong with it."""

    fits: dict[int, FrameFit] = field(default_factory=dict)
    failures: dict[int, ServiceError] = field(default_factory=dict)
    is_stopped: bool = False
    """Whether the observer asked to stop before all had their turn."""

    def add(self, others: "FrameResults") -> None:
        """Take up the results of other frames."""
        self.fits |= others.fits
        self.failures |= others.failures
        self.is_stopped |= others.is_stopped

    @contextmanager
    def failing_alone(self, index: int) -> Iterator[None]:
        """Keep the failure of one frame, where it is one that others may not share."""
        try:
            yield
        except InputError as error:
            self.failures[index] = error
        except InternalError as error:
            # A store that does not answer, to one, is no fault of the frame.
            if error.type not in _OF_A_FRAME:
                raise
            self.failures[index] = error


def fitted_chain(
    sequence: FrameSequence,
    steps: Sequence[FitStep],
    observer: Observer,
    checkpoints: Checkpoints,
) -> FrameResults:
    """The frames of the steps, which are posed, in this order. What was found is kept in `sequence`
    for those that come after. When the observer asks to stop, those that were finished. Raises an
    error that is no frame's own.
    """
    results = FrameResults()
    whole, done = sequence.plan.cost(steps), 0.0
    for step in steps:
        label = sequence.posed[step.frame].stack.label
        end = done + sequence.plan.cost([step]) / whole
        share = FrameShare(observer, label, done, min(end, 1.0))
        done = end
        place = Checkpoint(checkpoints, f"frame-{label}")
        try:
            with results.failing_alone(step.frame):
                results.fits[step.frame] = reconstruct_frame(step, sequence, share, place)
        except Cancelled:
            results.is_stopped = True
            break
        if step.frame in results.failures:
            sequence.forget(step.frame)
    return results
