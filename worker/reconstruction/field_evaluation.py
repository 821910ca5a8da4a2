"""A fitted field as plain functions of points, in numpy, in bounded memory, stopping when asked."""

from collections.abc import Iterator

import numpy as np
import torch

from worker.arrays import Hessians, Points
from worker.observer import Cancelled, Observer
from worker.reconstruction.network import TissueField
from worker.reconstruction.surface_logits import SurfaceLogits

_CHUNK = 16384
"""Points evaluated at once: keeps activations of a layer in the processor's cache."""

_MULTIPLICATIONS_AT_ONCE = 2**32
"""Points times weights between two looks at the observer: a fraction of a second."""


class FieldEvaluation:
    """Surface logits of a fit at any points, unit coordinates.

    Every method raises Cancelled when the observer asks to stop.
    """

    def __init__(
        self, field: TissueField, surface_logits: SurfaceLogits, observer: Observer
    ) -> None:
        self._field = field
        self._surface_logits = surface_logits
        self._observer = observer
        weights = sum(p.numel() for p in field.parameters())
        self._chunk = min(_CHUNK, max(1, _MULTIPLICATIONS_AT_ONCE // weights))

    @torch.no_grad()
    def logits(self, points_unit: Points) -> np.ndarray:
        """(n, 3) to (n, surfaces)."""
        parts = [self._surface_logits(self._field(p)) for p in self._chunks(points_unit)]
        return torch.cat(parts).numpy().astype(np.float64)

    @torch.no_grad()
    def logits_and_gradient(self, points_unit: Points, surface: int) -> tuple[np.ndarray, Points]:
        """Logits (n,) of one surface and their gradients (n, 3), per unit length."""
        values, slopes = [], []
        for chunk in self._chunks(points_unit):
            class_logits, jacobian = self._field.with_jacobian(chunk, len(chunk))
            gradients = self._surface_logits.gradient(class_logits, jacobian)
            values.append(self._surface_logits(class_logits)[:, surface])
            slopes.append(gradients[:, :, surface].t())
        return (
            torch.cat(values).numpy().astype(np.float64),
            torch.cat(slopes).numpy().astype(np.float64),
        )

    def gradient_and_hessian(self, points_unit: Points, surface: int) -> tuple[Points, Hessians]:
        """First and second derivatives of one surface's logit, (n, 3) and (n, 3, 3)."""
        slopes, bends = [], []
        for chunk in self._chunks(points_unit):
            points = chunk.clone().requires_grad_()
            logits = self._surface_logits.of_one(self._field(points), surface)
            (slope,) = torch.autograd.grad(logits.sum(), points, create_graph=True)
            rows = [
                torch.autograd.grad(slope[:, axis].sum(), points, retain_graph=axis < 2)[0]
                for axis in range(3)
            ]
            slopes.append(slope.detach())
            bends.append(torch.stack(rows, dim=1))
        return (
            torch.cat(slopes).numpy().astype(np.float64),
            torch.cat(bends).numpy().astype(np.float64),
        )

    def _chunks(self, points_unit: Points) -> Iterator[torch.Tensor]:
        for chunk in torch.as_tensor(points_unit, dtype=torch.float32).split(self._chunk):
            if self._observer.is_cancelled():
                raise Cancelled
            yield chunk
