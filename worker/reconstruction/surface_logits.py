"""From class logits to the logit of a union of classes.

logit_s = logsumexp(z in s) - logsumexp(z not in s), so sigmoid(logit_s) is the softmax probability
of the union, and a union's logit is never below that of a part of it.
"""

import torch
from torch import Tensor

from worker.reconstruction.tissues import Partition

_NEVER = -1e9
"""Stands for minus infinity; finite, so that its gradient is zero and not NaN."""


class SurfaceLogits:
    """The logits of a partition's surfaces."""

    def __init__(self, partition: Partition) -> None:
        encloses = torch.as_tensor(partition.encloses)
        self._inside = torch.where(encloses, 0.0, _NEVER)
        self._outside = torch.where(encloses, _NEVER, 0.0)

    def __call__(self, class_logits: Tensor) -> Tensor:
        """(n, classes) to (n, surfaces)."""
        z = class_logits.unsqueeze(1)
        return torch.logsumexp(z + self._inside, dim=2) - torch.logsumexp(z + self._outside, dim=2)

    def with_gradient(self, class_logits: Tensor, jacobian: Tensor) -> tuple[Tensor, Tensor]:
        """Surface logits (n, surfaces) and gradients (3, n, surfaces) by the chain rule.

        jacobian: (3, n, classes) derivatives of the class logits.
        """
        z = class_logits.unsqueeze(1)
        inside, outside = z + self._inside, z + self._outside
        logits = torch.logsumexp(inside, dim=2) - torch.logsumexp(outside, dim=2)
        weights = torch.softmax(inside, dim=2) - torch.softmax(outside, dim=2)
        return logits, torch.einsum("nsc,dnc->dns", weights, jacobian)
