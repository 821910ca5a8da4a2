"""The fit: six levels of samples that close in on the contours, one field for all surfaces.

Paper, section "Neural field-based reconstruction": total loss = BCE + lambda * hinge, each level a
fixed number of iterations, recent levels kept in the mix.
"""

import math
from collections.abc import Callable
from dataclasses import dataclass
from typing import Any

import torch
from torch import Tensor

from schemas.job import Progress, Stage
from schemas.options import Options
from worker.arrays import Points
from worker.reconstruction.alignment import SliceShifts
from worker.reconstruction.losses import bce, hinge
from worker.reconstruction.network import TissueField
from worker.reconstruction.observer import Cancelled, Observer
from worker.reconstruction.samples import LabelledSamples, joined
from worker.reconstruction.surface_logits import SurfaceLogits
from worker.reconstruction.tissues import Partition
from worker.reconstruction.unit_stack import UnitStack

_PRIOR_WEIGHT = 2e-4
"""Weight of the shift prior against the mean BCE: it breaks ties, the contours decide."""

_WIDEST_PRIOR, _FURTHEST_SHIFT = 0.1, 0.4
"""Bounds on the shift prior and on shifts, unit lengths: a mouse's breath is not a man's."""


@dataclass(frozen=True)
class FittedLevel:
    """Losses of one level, averaged over its iterations."""

    level: int
    samples: int
    bce: float
    hinge: float


@dataclass(frozen=True, eq=False)
class FieldFit:
    """A fitted field, the shift found for every slice (slices, 3) in unit lengths, and losses."""

    field: TissueField
    surface_logits: SurfaceLogits
    shifts_unit: Points
    levels: tuple[FittedLevel, ...]


def fit_field(
    samples_of: Callable[[int], LabelledSamples],
    stack: UnitStack,
    partition: Partition,
    options: Options,
    unit_mm: float,
    observer: Observer,
) -> FieldFit:
    """Fit one field to one frame.

    samples_of: fresh samples of a level, per-surface arrays in the order of `partition.surfaces`.
    stack: the slices with the outlines of those surfaces, for the shifts.
    unit_mm: length of one unit in mm.
    Raises Cancelled when the observer asks to stop.
    """
    generator = torch.Generator().manual_seed(options.seed)
    surface_logits = SurfaceLogits(partition)
    field = TissueField(partition.class_count, options.network, generator)
    shifts = SliceShifts(
        stack,
        min(options.alignment.prior_mm / unit_mm, _WIDEST_PRIOR),
        min(options.alignment.max_shift_mm / unit_mm, _FURTHEST_SHIFT),
    )
    groups: list[dict[str, Any]] = [
        {"params": list(field.parameters())},
        {"params": list(shifts.parameters()), "lr": options.alignment.learning_rate},
    ]
    optimizer = torch.optim.Adam(
        groups,
        lr=options.optimizer.learning_rate,
        foreach=True,
    )
    total_steps = options.levels * options.iterations_per_level
    schedule = torch.optim.lr_scheduler.LambdaLR(optimizer, _cosine(total_steps))

    recent: list[LabelledSamples] = []
    fitted: list[FittedLevel] = []
    for level in range(options.levels):
        recent = [*recent, samples_of(level)][-options.sampling.levels_in_mix :]
        mix = _Mix(joined(recent))
        align = options.align_slices and level >= options.alignment.first_level
        sums = torch.zeros(2)
        for iteration in range(options.iterations_per_level):
            if observer.is_cancelled():
                raise Cancelled
            batch = mix.draw(options.optimizer.samples_per_step, generator)
            optimizer.zero_grad(set_to_none=True)
            losses = _losses(field, surface_logits, shifts if align else None, batch, options)
            total = losses[0] + options.loss.hinge_weight * losses[1]
            if align:
                total = total + _PRIOR_WEIGHT * shifts.negative_log_prior()
            total.backward()
            optimizer.step()
            schedule.step()
            if align:
                shifts.restrain()
            sums += losses.detach()
            done = level * options.iterations_per_level + iteration + 1
            observer.advanced(
                Progress(
                    fraction=done / total_steps,
                    stage=Stage.FITTING,
                    level=level,
                    iteration=iteration,
                    loss=float(total.detach()),
                )
            )
        means = (sums / options.iterations_per_level).tolist()
        fitted.append(FittedLevel(level, len(mix), means[0], means[1]))
    return FieldFit(field, surface_logits, shifts.found(), tuple(fitted))


def _losses(
    field: TissueField,
    surface_logits: SurfaceLogits,
    shifts: SliceShifts | None,
    batch: "_Batch",
    options: Options,
) -> Tensor:
    points = batch.points
    if shifts is not None:
        points = shifts.aligned(points, batch.slice_index)
    count = options.loss.hinge_samples
    logits = surface_logits(field(points))
    _, gradients = surface_logits.with_gradient(*field.with_jacobian(points[:count].detach()))
    return torch.stack(
        [bce(logits, batch.targets, batch.known), hinge(gradients, options.loss.hinge_slope)]
    )


@dataclass(frozen=True, eq=False)
class _Batch:
    points: Tensor
    targets: Tensor
    known: Tensor
    slice_index: Tensor


class _Mix:
    """Samples of the recent levels as tensors to draw batches from."""

    def __init__(self, samples: LabelledSamples) -> None:
        self._points = torch.as_tensor(samples.points_unit, dtype=torch.float32)
        self._targets = torch.as_tensor(samples.targets, dtype=torch.float32)
        self._known = torch.as_tensor(samples.known, dtype=torch.float32)
        self._slice_index = torch.as_tensor(samples.slice_index)

    def __len__(self) -> int:
        return len(self._points)

    def draw(self, count: int, generator: torch.Generator) -> _Batch:
        chosen = torch.randint(len(self), (count,), generator=generator)
        return _Batch(
            self._points[chosen],
            self._targets[chosen],
            self._known[chosen],
            self._slice_index[chosen],
        )


def _cosine(steps: int) -> Callable[[int], float]:
    return lambda step: 0.5 * (1.0 + math.cos(math.pi * min(step / steps, 1.0)))
