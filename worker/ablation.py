"""The method's ablation: how good surfaces are when refinement ends at level 0, 1, ...

Each end is a complete fit of its own: its learning rate decays to the end of its last level. Paper,
"Evaluation of the geometric correspondence" and the figures by refinement level.
"""

from collections.abc import Collection, Mapping, Sequence

from intake.references import check_reference_surfaces
from schemas.options import Holdout, Options
from schemas.problem import InputError, ProblemType
from schemas.study import ContourStudy
from worker.ablation_row import AblatedSurface, measured_level
from worker.observer import Observer, Unobserved
from worker.progress_share import ProgressShare
from worker.reconstruction.pipeline import reconstruct
from worker.reconstruction.sampling import level_radius
from worker.surface_mesh import SurfaceMesh


def up_to_level(level: int, options: Options) -> Options:
    """The same fit, ended with level `level` of `options.levels`, each level's radius as it was.

    Raises InputError for a level that the full fit has not.
    """
    if not 0 <= level < options.levels:
        raise InputError(
            ProblemType.INVALID_REQUEST,
            f"There is no level {level} in a fit of {options.levels}; choose from 0 to "
            f"{options.levels - 1}, or raise `levels` in the options.",
        )
    if level == options.levels - 1:
        return options
    last_radius = level_radius(level, options.levels, options.sampling)
    sampling = options.sampling.model_copy(update={"last_radius": last_radius})
    return options.model_copy(update={"levels": level + 1, "sampling": sampling})


def check_references(names: Collection[str], study: ContourStudy, options: Options) -> None:
    """Raises InputError for a name that no surface of the reconstruction will have, and for
    references that are to be laid onto first: levels are compared as their surfaces lie.
    """
    check_reference_surfaces(study, options, names)
    if names and options.reference.align:
        raise InputError(
            ProblemType.INVALID_REQUEST,
            "Levels are held against references as they lie; leave `reference.align` out of the "
            "options.",
        )


def ablate(
    study: ContourStudy,
    options: Options,
    levels: Sequence[int],
    references: Mapping[str, SurfaceMesh],
    observer: Observer | None = None,
) -> list[AblatedSurface]:
    """Every surface of an admitted study, refined up to each of `levels` in turn.

    Args:
        study: In its own units and axes, admitted by `intake.study.admit`.
        options: Of the full fit. No slice is held out, nothing is fitted again with other seeds.
        levels: Ends of refinement, each from 0 to `options.levels - 1`.
        references: By name (`schemas.surface_name`), mm, in the study's axes.
        observer: Told of progress over all fits, asked whether to stop.

    Raises:
        InputError: as of `up_to_level`, `check_references` and `reconstruct`.
        InternalError: a fit encloses nothing.
        Cancelled: the observer asked to stop.
    """
    check_references(references.keys(), study, options)
    # Further fits of the same would be in no row.
    once = options.model_copy(update={"holdout": Holdout.NONE, "ensemble": 0})
    fits = {level: up_to_level(level, once) for level in levels}
    cost, done = sum(fit.levels for fit in fits.values()), 0
    found: list[AblatedSurface] = []
    for level, fit in fits.items():
        share = ProgressShare(observer or Unobserved(), done / cost, (done + fit.levels) / cost)
        for frame in reconstruct(study, fit, share).frames:
            found += measured_level(level, frame, fit, references)
        done += fit.levels
    return found
