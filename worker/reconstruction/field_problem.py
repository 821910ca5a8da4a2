"""What one field is fitted to: slices, the hull beyond which nothing of the heart is, and classes.

A part of the pipeline: it joins stages that do not know each other.
"""

from dataclasses import dataclass, replace

import numpy as np

from schemas.options import Options, SamplingOptions
from schemas.vocabulary import Structure
from worker.arrays import Points
from worker.checkpoints import Checkpoint
from worker.observer import Observer
from worker.reconstruction.alignment import SliceShifts
from worker.reconstruction.fit import FieldFit, fit_field
from worker.reconstruction.hull import Hull, inflated_hull
from worker.reconstruction.motion import SliceMotion, moved_back
from worker.reconstruction.network import TissueField
from worker.reconstruction.samples import LabelledSamples
from worker.reconstruction.sampling import level_radius, sample_level
from worker.reconstruction.stack_ends import past_the_ends
from worker.reconstruction.tissues import Partition
from worker.reconstruction.unit_stack import UnitSlice, UnitStack


@dataclass(frozen=True, eq=False)
class FieldProblem:
    """One frame in unit coordinates, and the classes that its field tells apart."""

    stack: UnitStack
    hull: Hull
    classes: Partition

    @property
    def shown(self) -> UnitStack:
        """The slices with the outlines of the classes' surfaces alone."""
        return self.stack.showing(self.classes.surfaces)


def posed(stack: UnitStack, classes: Partition, sampling: SamplingOptions) -> FieldProblem:
    """The problem that a stack poses. Raises InputError for outlines that enclose no volume."""
    ends = past_the_ends(stack, sampling.hull_inflation)
    hull = inflated_hull(np.concatenate([stack.points_unit, ends]), sampling.hull_inflation)
    return FieldProblem(stack, hull, classes)


def solved(
    problem: FieldProblem,
    shifts: SliceShifts,
    options: Options,
    observer: Observer,
    start: TissueField | None = None,
    checkpoint: Checkpoint | None = None,
) -> FieldFit:
    """A field fitted to the problem, from `start` or from the seed; shifts are learned in place.

    checkpoint: where the fit is kept level by level, and gone on from. Raises Cancelled when the
    observer asks to stop.
    """
    rng = np.random.default_rng(options.seed)

    def samples_of(level: int) -> LabelledSamples:
        radius = level_radius(level, options.levels, options.sampling)
        return sample_level(
            problem.stack,
            problem.classes.surfaces,
            problem.hull,
            radius,
            options.sampling,
            rng,
            observer,
        )

    return fit_field(samples_of, shifts, problem.classes, options, observer, start, checkpoint)


def moved_stack(stack: UnitStack, motion: SliceMotion) -> UnitStack:
    """The stack with every slice where the heart is: its plane moved back by its motion."""
    return UnitStack(tuple(_moved(one, motion, i) for i, one in enumerate(stack.slices)))


def outline_points(stack: UnitStack) -> dict[Structure, Points]:
    """All outline points (n, 3) of every structure, unit coordinates."""
    points: dict[Structure, list[Points]] = {}
    for slice_ in stack.slices:
        for structure, outlines in slice_.outlines.items():
            points.setdefault(structure, []).extend(slice_.lift(o.points) for o in outlines)
    return {structure: np.concatenate(parts) for structure, parts in points.items()}


def _moved(slice_: UnitSlice, motion: SliceMotion, index: int) -> UnitSlice:
    turn, normal = float(motion.turns[index]), slice_.normal
    still = np.zeros(3)
    return replace(
        slice_,
        origin=moved_back(
            slice_.origin[None], motion.shifts[index], turn, motion.pivots[index], normal
        )[0],
        axes=moved_back(slice_.axes, still, turn, still, normal),
    )
