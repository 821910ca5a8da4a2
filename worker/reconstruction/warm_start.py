"""A fit that goes on from the field of a neighbour in time: its start, and its shorter schedule."""

from schemas.options import Options
from worker.reconstruction.affine_motion import affine_motion
from worker.reconstruction.field_problem import outline_points
from worker.reconstruction.network import TissueField
from worker.reconstruction.sampling import level_radius
from worker.reconstruction.unit_stack import UnitStack


def warm_options(options: Options) -> Options:
    """The last levels of the same ladder: more steps of fewer samples come further than as many
    samples in fewer steps, and a low rate does not forget the field that it starts from.
    """
    full, less = options, options.sequence
    levels = min(less.levels, full.levels)
    first_radius = level_radius(full.levels - levels, full.levels, full.sampling)
    step = min(less.samples_per_step, full.optimizer.samples_per_step)
    rate = min(less.learning_rate, full.optimizer.learning_rate)
    return options.model_copy(
        update={
            "levels": levels,
            "iterations_per_level": min(less.iterations_per_level, full.iterations_per_level),
            "sampling": full.sampling.model_copy(update={"first_radius": first_radius}),
            "optimizer": full.optimizer.model_copy(
                update={"learning_rate": rate, "samples_per_step": step}
            ),
        }
    )


def moved_onto(field: TissueField, before: UnitStack, after: UnitStack) -> TissueField:
    """The field of one frame, moved as its outlines are onto those of another.

    Both stacks with every slice where the heart is, in one unit frame.
    """
    return field.moved(affine_motion(outline_points(before), outline_points(after)))
