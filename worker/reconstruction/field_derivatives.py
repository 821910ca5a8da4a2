"""Values and derivatives of one surface's logit, without the machinery of a fit.

What a fit needs is the derivatives of all classes; a surface needs those of one number. From that
number back through the layers they cost as much as its value does. Notation: h the values of a
layer, z their phases, so that h = sin z; a dot is a derivative along a direction.
"""

from dataclasses import dataclass

import torch
from torch import Tensor

from worker.reconstruction.network import TissueField
from worker.reconstruction.surface_logits import SurfaceLogits


@dataclass(frozen=True, eq=False)
class _Forward:
    """sines, cosines: of the phases of every layer, (n, width) each. logits: (n, classes)."""

    sines: list[Tensor]
    cosines: list[Tensor]
    logits: Tensor


@torch.no_grad()
def class_logits(field: TissueField, points_unit: Tensor) -> Tensor:
    """(n, 3) to (n, classes): what calling the field gives, in less memory."""
    hidden = torch.addmm(field.biases[0], points_unit, field.first).sin_()
    for bias, weight in zip(field.biases[1:], field.hidden, strict=True):
        hidden = torch.addmm(bias, hidden, weight).sin_()
    return torch.addmm(field.last_bias, hidden, field.last)


@torch.no_grad()
def logit_and_gradient(
    field: TissueField, surface_logits: SurfaceLogits, points_unit: Tensor, surface: int
) -> tuple[Tensor, Tensor]:
    """The logit (n,) of one surface and its gradient (n, 3) at (n, 3) points."""
    forward = _forward(field, points_unit)
    logit, slope = surface_logits.with_slope(forward.logits, surface)
    _, gradient = _back(field, forward, slope)
    return logit, gradient


@torch.no_grad()
def gradient_and_hessian(
    field: TissueField, surface_logits: SurfaceLogits, points_unit: Tensor, surface: int
) -> tuple[Tensor, Tensor]:
    """Its gradient (n, 3) and its second derivatives (n, 3, 3).

    Along each axis in turn everything is differentiated on the way there and on the way back.
    """
    forward, count = _forward(field, points_unit), len(points_unit)
    _, slope = surface_logits.with_slope(forward.logits, surface)
    by_values, gradient = _back(field, forward, slope)
    phases = [field.first.unsqueeze(1).expand(3, count, -1)]
    for cosine, weight in zip(forward.cosines, field.hidden, strict=False):
        phases.append(_through(cosine * phases[-1], weight))
    dotted = _through(forward.cosines[-1] * phases[-1], field.last)
    bend = surface_logits.slope_along(forward.logits, dotted, surface)
    onward = _through(bend, field.last.t())
    for depth in range(len(phases) - 1, -1, -1):
        turned = by_values[depth] * forward.sines[depth]
        onward = torch.addcmul(onward * forward.cosines[depth], turned, phases[depth], value=-1.0)
        onward = _through(onward, _weight(field, depth).t())
    return gradient, onward.transpose(0, 1)


def _through(rows: Tensor, weight: Tensor) -> Tensor:
    """(3, n, width) times a matrix."""
    return (rows.flatten(0, 1) @ weight).view(3, -1, weight.shape[1])


def _weight(field: TissueField, depth: int) -> Tensor:
    return field.hidden[depth - 1] if depth else field.first


def _forward(field: TissueField, points_unit: Tensor) -> _Forward:
    sines: list[Tensor] = []
    cosines = []
    values = points_unit
    for depth, bias in enumerate(field.biases):
        phases = torch.addmm(bias, values, _weight(field, depth))
        cosines.append(torch.cos(phases))
        values = phases.sin_()
        sines.append(values)
    return _Forward(sines, cosines, torch.addmm(field.last_bias, values, field.last))


def _back(field: TissueField, forward: _Forward, slope: Tensor) -> tuple[list[Tensor], Tensor]:
    """Derivatives of the logit by each layer's values, (n, width), and by position, (n, 3).

    slope: (n, classes), those by the class logits.
    """
    by_values: list[Tensor] = []
    onward = slope @ field.last.t()
    for depth in range(len(forward.cosines) - 1, -1, -1):
        by_values.insert(0, onward)
        onward = (onward * forward.cosines[depth]) @ _weight(field, depth).t()
    return by_values, onward
