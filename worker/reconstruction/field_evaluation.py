"""A fitted field as plain functions of points, in numpy and in bounded memory."""

from collections.abc import Iterator

import numpy as np
import torch

from worker.arrays import Points
from worker.reconstruction.network import TissueField
from worker.reconstruction.surface_logits import SurfaceLogits

_CHUNK = 16384
"""Points evaluated at once: keeps activations of a layer in the processor's cache."""


class FieldEvaluation:
    """Surface logits of a fit at any points, unit coordinates."""

    def __init__(self, field: TissueField, surface_logits: SurfaceLogits) -> None:
        self._field = field
        self._surface_logits = surface_logits

    @torch.no_grad()
    def logits(self, points_unit: Points) -> np.ndarray:
        """(n, 3) to (n, surfaces)."""
        parts = [self._surface_logits(self._field(p)) for p in _chunks(points_unit)]
        return torch.cat(parts).numpy().astype(np.float64)

    @torch.no_grad()
    def logits_and_gradient(self, points_unit: Points, surface: int) -> tuple[np.ndarray, Points]:
        """Logits (n,) of one surface and their gradients (n, 3), per unit length."""
        values, slopes = [], []
        for chunk in _chunks(points_unit):
            logits, gradients = self._surface_logits.with_gradient(
                *self._field.with_jacobian(chunk)
            )
            values.append(logits[:, surface])
            slopes.append(gradients[:, :, surface].t())
        return (
            torch.cat(values).numpy().astype(np.float64),
            torch.cat(slopes).numpy().astype(np.float64),
        )


def _chunks(points_unit: Points) -> Iterator[torch.Tensor]:
    return iter(torch.as_tensor(points_unit, dtype=torch.float32).split(_CHUNK))
