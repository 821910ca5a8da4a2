"""A fitted field as plain functions of points, in numpy, in bounded memory, stopping when asked."""

from collections.abc import Callable, Iterator

import numpy as np
import torch

from worker.arrays import Hessians, Points
from worker.observer import Cancelled, Observer
from worker.reconstruction.field_derivatives import (
    class_logits,
    gradient_and_hessian,
    logit_and_gradient,
)
from worker.reconstruction.network import TissueField
from worker.reconstruction.surface_logits import SurfaceLogits

_CHUNK, _CHUNK_WITH_DERIVATIVES = 16384, 512
"""Points evaluated at once: keeps activations in the processor's cache."""

_Asked = Callable[
    [TissueField, SurfaceLogits, torch.Tensor, int], tuple[torch.Tensor, torch.Tensor]
]

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
        self._most = max(1, _MULTIPLICATIONS_AT_ONCE // weights)

    @torch.no_grad()
    def logits(self, points_unit: Points) -> np.ndarray:
        """(n, 3) to (n, surfaces)."""
        parts = [
            self._surface_logits(class_logits(self._field, chunk))
            for chunk in self._chunks(points_unit, _CHUNK)
        ]
        return torch.cat(parts).numpy().astype(np.float64)

    def logits_and_gradient(self, points_unit: Points, surface: int) -> tuple[np.ndarray, Points]:
        """Logits (n,) of one surface and their gradients (n, 3), per unit length."""
        return self._of_surface(logit_and_gradient, points_unit, surface)

    def gradient_and_hessian(self, points_unit: Points, surface: int) -> tuple[Points, Hessians]:
        """First and second derivatives of one surface's logit, (n, 3) and (n, 3, 3)."""
        return self._of_surface(gradient_and_hessian, points_unit, surface)

    def _of_surface(
        self, asked: _Asked, points_unit: Points, surface: int
    ) -> tuple[np.ndarray, np.ndarray]:
        parts = [
            asked(self._field, self._surface_logits, chunk, surface)
            for chunk in self._chunks(points_unit, _CHUNK_WITH_DERIVATIVES)
        ]
        first, second = (torch.cat(every) for every in zip(*parts, strict=True))
        return first.numpy().astype(np.float64), second.numpy().astype(np.float64)

    def _chunks(self, points_unit: Points, most: int) -> Iterator[torch.Tensor]:
        size = min(most, self._most)
        for chunk in torch.as_tensor(points_unit, dtype=torch.float32).split(size):
            if self._observer.is_cancelled():
                raise Cancelled
            yield chunk
