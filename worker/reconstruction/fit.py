"""The fit: six levels of samples that close in on the contours, one field for all surfaces.

Paper, section "Neural field-based reconstruction": total loss = BCE + lambda * hinge, each level a
fixed number of iterations, recent levels kept in the mix.
"""

import math
from collections.abc import Callable
from copy import deepcopy
from dataclasses import dataclass

import numpy as np
import torch
from torch import Tensor

from schemas.job import Progress, Stage
from schemas.options import Options
from worker.checkpoints import Checkpoint
from worker.observer import Cancelled, Observer
from worker.reconstruction.alignment import SliceShifts
from worker.reconstruction.descent import Descent
from worker.reconstruction.fit_state import FitState
from worker.reconstruction.fitted_level import FittedLevel
from worker.reconstruction.losses import bce, hinge
from worker.reconstruction.network import TissueField
from worker.reconstruction.samples import BOUNDARY, LabelledSamples, joined
from worker.reconstruction.surface_logits import SurfaceLogits
from worker.reconstruction.tissues import Partition


@dataclass(frozen=True, eq=False)
class FieldFit:
    """A fitted field and the losses on the way to it."""

    field: TissueField
    surface_logits: SurfaceLogits
    levels: tuple[FittedLevel, ...]


def fit_field(
    samples_of: Callable[[int], LabelledSamples],
    shifts: SliceShifts,
    partition: Partition,
    options: Options,
    observer: Observer,
    start: TissueField | None = None,
    checkpoint: Checkpoint | None = None,
) -> FieldFit:
    """Fit one field to one frame.

    samples_of: fresh samples of a level, per-surface arrays in the order of `partition.surfaces`.
    shifts: of the slices that samples were drawn on; where they move, learned with the field, in
        place.
    start: a field to go on from, which is left as it is; a new one by the seed when None.
    checkpoint: where the state is kept after every level. A fit that finds one goes on from there,
        bit for bit as if it had never stopped.
    Raises Cancelled when the observer asks to stop.
    """
    generator = torch.Generator().manual_seed(options.seed)
    surface_logits = SurfaceLogits(partition)
    field = deepcopy(start) or TissueField(partition.class_count, options.network, generator)
    descent = Descent(field, shifts, options)
    total_steps = options.levels * options.iterations_per_level

    checkpoint = checkpoint or Checkpoint()
    state = FitState(field, shifts, descent, generator)
    fitted = state.load(checkpoint)
    kept = len(fitted)
    if kept:
        # Without an iteration: an earlier attempt came this far.
        done = kept / options.levels
        observer.advanced(Progress(fraction=done, stage=Stage.FITTING, level=kept - 1))
    recent: list[LabelledSamples] = []
    for level in range(options.levels if kept < options.levels else 0):
        # Of levels that were kept, too: later samples are drawn after them, and mixed with them.
        recent = [*recent, samples_of(level)][-options.sampling.levels_in_mix :]
        if level < kept:
            continue
        mix = _Mix(joined(recent), options.loss.contour_weight)
        learning = shifts.moving and level >= options.alignment.first_level
        seen = torch.zeros(2, options.iterations_per_level)
        for iteration in range(options.iterations_per_level):
            if observer.is_cancelled():
                raise Cancelled
            batch = mix.draw(options.optimizer.samples_per_step, generator)
            points = shifts.aligned(batch.points, batch.slice_index)
            points = points if learning else points.detach()
            losses = _losses(field, surface_logits, points, batch, options)
            total = losses[0] + options.loss.hinge_weight * losses[1]
            if learning:
                total = total + shifts.penalty()
            done = level * options.iterations_per_level + iteration
            descent.step(total, _cosine(done / total_steps))
            seen[:, iteration] = losses.detach()
            observer.advanced(
                Progress(
                    fraction=(done + 1) / total_steps,
                    stage=Stage.FITTING,
                    level=level,
                    iteration=iteration,
                    loss=float(total.detach()),
                )
            )
        fitted.append(FittedLevel(level, len(mix), *seen.numpy().astype(np.float64)))
        state.save(fitted, options.levels, checkpoint)
    return FieldFit(field, surface_logits, tuple(fitted))


def _losses(
    field: TissueField,
    surface_logits: SurfaceLogits,
    points: Tensor,
    batch: "_Batch",
    options: Options,
) -> Tensor:
    count = min(options.loss.hinge_samples, len(points)) if options.loss.hinge_weight > 0.0 else 0
    class_logits, jacobian = field.with_jacobian(points, count)
    logits = surface_logits(class_logits)
    steepness = logits.new_zeros(())
    if count > 0:
        gradients = surface_logits.gradient(class_logits[:count], jacobian)
        steepness = hinge(gradients, options.loss.hinge_slope)
    return torch.stack([bce(logits, batch.targets, batch.weights), steepness])


@dataclass(frozen=True, eq=False)
class _Batch:
    points: Tensor
    targets: Tensor
    weights: Tensor
    slice_index: Tensor


class _Mix:
    """Samples of the recent levels as tensors to draw batches from."""

    def __init__(self, samples: LabelledSamples, contour_weight: float) -> None:
        weights = np.where(samples.targets == BOUNDARY, contour_weight, 1.0) * samples.known
        # One row a sample: a batch is one gathering.
        rows = np.concatenate([samples.points_unit, samples.targets, weights], axis=1)
        self._rows = torch.as_tensor(rows, dtype=torch.float32)
        self._slice_index = torch.as_tensor(samples.slice_index)
        surfaces = samples.targets.shape[1]
        self._columns = [3, surfaces, surfaces]

    def __len__(self) -> int:
        return len(self._rows)

    def draw(self, count: int, generator: torch.Generator) -> _Batch:
        chosen = torch.randint(len(self), (count,), generator=generator)
        points, targets, weights = self._rows.index_select(0, chosen).split(self._columns, dim=1)
        return _Batch(points, targets, weights, self._slice_index.index_select(0, chosen))


def _cosine(done: float) -> float:
    """From one to zero, as `done` goes from zero to one."""
    return 0.5 * (1.0 + math.cos(math.pi * min(done, 1.0)))
