"""The frames of one subject as one job: what each frame has of those that were fitted before it.

A part of the pipeline: it joins stages that do not know each other.
"""

from collections.abc import Mapping, Sequence
from copy import copy
from dataclasses import dataclass

import numpy as np

from intake.effort import warm_cost
from schemas.cycle_report import FEWEST_FRAMES
from schemas.options import Options
from worker.reconstruction.cycle import FitStep, fit_order, in_time, observed_area
from worker.reconstruction.field_problem import moved_stack
from worker.reconstruction.motion import SliceMotion
from worker.reconstruction.network import TissueField
from worker.reconstruction.normalisation import UnitFrame, unit_frame_of
from worker.reconstruction.posed_frame import PosedFrame
from worker.reconstruction.shared_shifts import (
    SharedShifts,
    share_planes,
    shared_from,
    shared_shifts,
)
from worker.reconstruction.shift_evidence import ShiftEvidence
from worker.reconstruction.slice_stack import SliceStack
from worker.reconstruction.stack_evidence import prior_and_noise, stack_evidence
from worker.reconstruction.unit_stack import UnitStack
from worker.reconstruction.warm_start import moved_onto

_NOTABLE_MM = 1.0
"""Frames that place a slice nearer to each other than this are not worth a warning."""


@dataclass(frozen=True, eq=False)
class SequencePlan:
    """steps: whose turn it is. warm_cost: of one that goes on from a neighbour, beside 1 for a fit
    from nothing. unit_frame: of all frames together; None where each has its own. is_warm,
    is_shared: whether frames go on from each other, and whether their slices may share shifts.
    """

    steps: tuple[FitStep, ...]
    warm_cost: float
    unit_frame: UnitFrame | None
    is_warm: bool
    is_shared: bool

    def cost(self, steps: Sequence[FitStep]) -> float:
        """Of the steps together."""
        return sum((self.warm_cost if step.before else 1.0 for step in steps), 0.0)


@dataclass(frozen=True, eq=False)
class Start:
    """A field to go on from, and whose it was."""

    label: str
    field: TissueField


def sequence_plan(stacks: Sequence[SliceStack], options: Options) -> SequencePlan:
    """How the frames of a study are to be fitted; a frame alone as ever."""
    count, chosen = len(stacks), options.sequence
    is_warm = chosen.warm_start and count >= FEWEST_FRAMES
    is_shared = (
        chosen.share_shifts and count > 1 and options.align_slices and not options.alignment.rotate
    )
    if not (is_warm or is_shared):
        alone = tuple(FitStep(index, ()) for index in range(count))
        return SequencePlan(alone, 1.0, None, is_warm=False, is_shared=False)
    order = in_time([stack.time_ms for stack in stacks])
    first = int(np.argmax([observed_area(stacks[index]) for index in order]))
    steps = tuple(
        FitStep(order[step.frame], tuple(order[k] for k in step.before) if is_warm else ())
        for step in fit_order(first, count, whole_cycle=chosen.whole_cycle)
    )
    together = SliceStack("", None, tuple(s for stack in stacks for s in stack.slices))
    return SequencePlan(steps, warm_cost(options), unit_frame_of(together), is_warm, is_shared)


class FrameSequence:
    """The frames of a plan, and what the fits so far have found."""

    def __init__(
        self, plan: SequencePlan, posed: Mapping[int, PosedFrame], options: Options
    ) -> None:
        """posed: the frames that could be posed."""
        self.posed = posed
        self.plan = plan
        self.options = options
        self._fitted: dict[int, tuple[TissueField, UnitStack]] = {}
        self._warnings: list[str] = []
        self._shared: SharedShifts | None = None
        if plan.is_shared and posed:
            self._share()

    def branch(self) -> "FrameSequence":
        """The same so far; what is fitted from now on, one does not learn of the other."""
        other = copy(self)
        other._fitted = dict(self._fitted)
        return other

    def evidence_of(self, index: int) -> ShiftEvidence:
        """Of a frame's slices: from all frames, for good once one of them has been fitted."""
        frame = self.posed[index]
        if self._shared is not None:
            return self._shared.of(frame.problem.stack)
        return self._own_evidence(frame)

    def start_of(self, step: FitStep) -> Start | None:
        """From the nearest frame on the way to it that was fitted to the same surfaces; None for a
        fit from nothing.
        """
        frame = self.posed[step.frame]
        told_apart = frame.problem.classes.surfaces
        before = next(
            (
                index
                for index in step.before
                if index in self._fitted
                and self.posed[index].problem.classes.surfaces == told_apart
            ),
            None,
        )
        if before is None:
            return None
        field, stack = self._fitted[before]
        evidence = self.evidence_of(step.frame)
        after = moved_stack(frame.problem.stack, _motion(frame.problem.stack, evidence))
        return Start(self.posed[before].stack.label, moved_onto(field, stack, after))

    def fitted(self, index: int, field: TissueField, motion: SliceMotion) -> SliceMotion:
        """Keep what a fit found, and say how the frame's slices are moved."""
        stack = self.posed[index].problem.stack
        if self._shared is not None:
            if not self._shared.evidence.final:
                shown = self.posed[index].problem.shown
                self._shared = self._shared.found(shown, motion.shifts)
            motion = self._shared.motion_of(stack)
        if self.plan.is_warm:
            self._fitted[index] = field, moved_stack(stack, motion)
        return motion

    def forget(self, index: int) -> None:
        """A frame of whose field no surface came is none to go on from."""
        self._fitted.pop(index, None)

    def warnings(self) -> tuple[str, ...]:
        """What was noticed over all frames."""
        return tuple(self._warnings)

    def _own_evidence(self, frame: PosedFrame) -> ShiftEvidence:
        shown, unit_mm = frame.problem.shown, frame.unit_frame.half_extent_mm
        return stack_evidence(shown, self.options, unit_mm)

    def _share(self) -> None:
        steps = [step.frame for step in self.plan.steps if step.frame in self.posed]
        frames = [self.posed[index] for index in steps]
        stacks = [frame.problem.shown for frame in frames]
        if not share_planes(stacks):
            self._warnings.append(
                "Slices of one id lie in different planes in different frames, so that each "
                "frame's slices were aligned by themselves. Give slices that are not one slice "
                "over time different ids."
            )
            return
        unit_mm = frames[0].unit_frame.half_extent_mm
        prior, noise = prior_and_noise(self.options, unit_mm)
        self._shared = shared_shifts(stacks, prior, noise)
        if self._shared is None:
            self._shared = shared_from(stacks, self._own_evidence(frames[0]), 0, prior)
        for one in self._shared.disagreements:
            if one.furthest * unit_mm >= _NOTABLE_MM:
                labels = ", ".join(
                    self.posed[index].stack.label for index in sorted(steps[k] for k in one.frames)
                )
                self._warnings.append(
                    f"Slice {one.slice_id}: its contours in {labels} place it up to "
                    f"{one.furthest * unit_mm:.1f} mm from where all frames together do. Look at "
                    "these contours; if the slice was not taken in one breath-hold, set "
                    "sequence.share_shifts to false."
                )


def _motion(stack: UnitStack, evidence: ShiftEvidence) -> SliceMotion:
    shifts = np.array(
        [m[:2] @ one.axes for one, m in zip(stack.slices, evidence.motion, strict=True)]
    )
    pivots = np.array([one.lift(one.pivot[None])[0] for one in stack.slices])
    return SliceMotion(shifts, evidence.motion[:, 2], pivots)
