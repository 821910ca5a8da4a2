"""From class logits to the logit of a union of classes.

logit_s = logsumexp(z in s) - logsumexp(z not in s), so sigmoid(logit_s) is the softmax probability
of the union, and a union's logit is never below that of a part of it.
"""

from typing import Any

import torch
from torch import Tensor
from torch.autograd.function import once_differentiable

from worker.reconstruction.tissues import Partition

_LEAST = 1e-30
"""Least share of a union: a logit is never beyond about 69, where it has no gradient any more."""


class SurfaceLogits:
    """The logits of a partition's surfaces."""

    def __init__(self, partition: Partition) -> None:
        self._inside = torch.as_tensor(partition.encloses.T, dtype=torch.float32)
        self._outside = 1.0 - self._inside

    def __call__(self, class_logits: Tensor) -> Tensor:
        """(n, classes) to (n, surfaces)."""
        logits: Tensor = _UnionLogits.apply(  # type: ignore[no-untyped-call]
            class_logits, self._inside, self._outside
        )
        return logits

    def with_slope(self, class_logits: Tensor, surface: int) -> tuple[Tensor, Tensor]:
        """Of one surface: (n, classes) to its logit (n,) and the derivatives (n, classes) of that
        by the class logits.
        """
        shares = torch.softmax(class_logits, dim=1)
        of_within, of_without, within, without = self._shares_of(shares, surface)
        return (torch.log(within) - torch.log(without)).squeeze(1), of_within - of_without

    def slope_along(self, class_logits: Tensor, directions: Tensor, surface: int) -> Tensor:
        """How these derivatives change along directions (k, n, classes) of the class logits."""
        shares = torch.softmax(class_logits, dim=1)
        of_within, of_without, _, _ = self._shares_of(shares, surface)
        inside = of_within * (directions - (of_within * directions).sum(-1, keepdim=True))
        outside = of_without * (directions - (of_without * directions).sum(-1, keepdim=True))
        return inside - outside

    def _shares_of(self, shares: Tensor, surface: int) -> tuple[Tensor, Tensor, Tensor, Tensor]:
        """Shares of the classes in what one surface encloses, and in the rest, (n, classes) each,
        and how much both are of all, (n, 1) each.
        """
        within = (shares @ self._inside[:, surface, None]).clamp_min(_LEAST)
        without = (shares @ self._outside[:, surface, None]).clamp_min(_LEAST)
        of_within = shares * self._inside[:, surface] / within
        return of_within, shares * self._outside[:, surface] / without, within, without

    def gradient(self, class_logits: Tensor, jacobian: Tensor) -> Tensor:
        """Gradients (3, n, surfaces) of the surface logits, by the chain rule.

        class_logits: (n, classes); jacobian: (3, n, classes), their derivatives.
        """
        shares = torch.softmax(class_logits, dim=1)
        inside = (shares @ self._inside).clamp_min(_LEAST)
        outside = (shares @ self._outside).clamp_min(_LEAST)
        carried = jacobian * shares
        return carried @ self._inside / inside - carried @ self._outside / outside


class _UnionLogits(torch.autograd.Function):
    """Both logarithms share one exponential, and the gradient is written out: a step asks for it
    as often as for the network's.
    """

    @staticmethod
    def forward(ctx: Any, class_logits: Tensor, inside: Tensor, outside: Tensor) -> Tensor:
        shares = torch.softmax(class_logits, dim=1)
        within = (shares @ inside).clamp_min_(_LEAST)
        without = (shares @ outside).clamp_min_(_LEAST)
        ctx.save_for_backward(shares, within, without, inside, outside)
        return torch.log(within) - torch.log(without)

    @staticmethod
    @once_differentiable
    def backward(ctx: Any, by_logits: Tensor) -> tuple[Tensor, None, None]:
        shares, within, without, inside, outside = ctx.saved_tensors
        by_shares = (by_logits / within) @ inside.t() - (by_logits / without) @ outside.t()
        return shares * by_shares, None, None
