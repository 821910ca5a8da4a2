"""How long a request is expected to take beside others: its work, 1 for a standard fit of a frame.

Effort counts fits; this also weighs them by what the options make of each.
"""

from intake.effort import MESHING_SHARE, effort
from schemas.options import Options
from schemas.study import ContourStudy


def contour_work(study: ContourStudy, options: Options) -> float:
    """Of an admitted study."""
    return effort(study, options) * _frame_work(options)


def label_work(frames: int, options: Options) -> float:
    """Of label maps, at most: only a worker finds which frames go on from a neighbour, and how many
    slices would be left out.
    """
    return frames * (1.0 + options.ensemble) * _frame_work(options)


def rescaled(work: float, before: Options, after: Options) -> float:
    """What is left of a label job's work, or becomes of it, with other options."""
    return work * label_work(1, after) / label_work(1, before)


def _frame_work(options: Options) -> float:
    standard = Options()
    fit = _steps(options) / _steps(standard)
    grid = (standard.mesh.grid_mm / options.mesh.grid_mm) ** 2
    return (1.0 - MESHING_SHARE) * fit + MESHING_SHARE * grid


def _steps(options: Options) -> float:
    """Samples carried through the network over all steps; a derivative is three more samples."""
    step, net = options.optimizer.samples_per_step, options.network
    samples = step + 4 * min(options.loss.hinge_samples, step)
    return options.levels * options.iterations_per_level * samples * net.depth * net.width**2
