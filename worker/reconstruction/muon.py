"""Muon: momentum whose matrices are made orthogonal, so that every direction learns alike.

Jordan et al. 2024 (kellerjordan.github.io/posts/muon), for a network's hidden matrices; the scale
that makes a step as long as Adam's is that of Liu et al. 2025 (arXiv 2502.16982).
"""

import torch
from torch import Tensor

_MOMENTUM = 0.95
_RMS = 0.2
"""Root mean square of an entry of a step at learning rate one, as Adam's typically is."""

_NEWTON_SCHULZ = (3.4445, -4.7750, 2.0315)
"""The quintic of Jordan et al.: singular values come within 0.7 and 1.2 in five steps."""

_STEPS = 5


class Muon:
    """Optimizer of one (count, n, n) stack of square matrices; `momentum` is all its state.

    Batched by hand: torch's own Muon takes one matrix at a time, in a number format that is slow on
    most processors.
    """

    def __init__(self, matrices: Tensor) -> None:
        self._matrices = matrices
        self.momentum = torch.zeros_like(matrices)
        self._scale = _RMS * matrices.shape[-1] ** 0.5

    @torch.no_grad()
    def step(self, learning_rate: float) -> None:
        """Move the matrices against the gradient that they hold, and let go of it."""
        gradient = self._matrices.grad
        if gradient is None:
            raise ValueError("the matrices hold no gradient; call backward first")
        self.momentum.mul_(_MOMENTUM).add_(gradient)
        ahead = gradient.add(self.momentum, alpha=_MOMENTUM)
        self._matrices.add_(orthogonalised(ahead), alpha=-learning_rate * self._scale)
        self._matrices.grad = None


def orthogonalised(matrices: Tensor) -> Tensor:
    """(count, n, n) with singular values near one, singular vectors kept; by Newton-Schulz."""
    a, b, c = _NEWTON_SCHULZ
    x = matrices / matrices.norm(dim=(1, 2), keepdim=True).clamp_min(1e-30)
    for _ in range(_STEPS):
        gram = x @ x.transpose(1, 2)
        x = a * x + torch.baddbmm(gram, gram, gram, beta=b, alpha=c) @ x
    return x
