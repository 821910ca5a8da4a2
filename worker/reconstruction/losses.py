"""The two terms of the method's loss (paper, Eqs. 2-4), on logits for their numerical range."""

import torch
from torch import Tensor
from torch.nn import functional


def bce(logits: Tensor, targets: Tensor, weights: Tensor) -> Tensor:
    """Weighted mean binary cross-entropy (Eq. 3).

    logits, targets, weights: (n, surfaces); an entry of weight 0 is one of which nothing is known.
    """
    each = functional.binary_cross_entropy_with_logits(logits, targets, reduction="none")
    return (each * weights).sum() / weights.sum().clamp_min(1e-12)


def hinge(gradients: Tensor, slope: float) -> Tensor:
    """Mean excess of the logit's gradient norm over `slope` (Eq. 4).

    gradients: (3, n, surfaces), logits per unit length. It caps the slope; it does not make the
    field a distance.
    """
    norms = torch.sqrt((gradients**2).sum(dim=0) + 1e-12)
    return functional.relu(norms - slope).mean()
