"""Adam (Kingma and Ba 2015), by torch's own function.

Not `torch.optim.Adam`: the first one in a process loads torch's compiler, which takes longer than
fitting a frame from its neighbour.
"""

from collections.abc import Sequence
from typing import Any

import torch
from torch import Tensor
from torch.optim.adam import adam


class Adam:
    """Optimizer of some tensors, each with the two running means of its gradient and its steps."""

    def __init__(self, parameters: Sequence[Tensor]) -> None:
        self._parameters = list(parameters)
        self._means = [torch.zeros_like(p) for p in self._parameters]
        self._squares = [torch.zeros_like(p) for p in self._parameters]
        self._steps = [torch.tensor(0.0) for _ in self._parameters]

    @torch.no_grad()
    def step(self, learning_rate: float) -> None:
        """Move those that hold a gradient against it, and let go of it."""
        held = [k for k, p in enumerate(self._parameters) if p.grad is not None]
        gradients = [p.grad for p in self._parameters if p.grad is not None]
        adam(
            [self._parameters[k] for k in held],
            gradients,
            [self._means[k] for k in held],
            [self._squares[k] for k in held],
            [],
            [self._steps[k] for k in held],
            foreach=True,
            amsgrad=False,
            beta1=0.9,
            beta2=0.999,
            lr=learning_rate,
            weight_decay=0.0,
            eps=1e-8,
            maximize=False,
        )
        for k in held:
            self._parameters[k].grad = None

    def state(self) -> dict[str, Any]:
        """All that `put_back` needs to go on as if never stopped."""
        return {"means": self._means, "squares": self._squares, "steps": self._steps}

    def put_back(self, state: dict[str, Any]) -> None:
        """Go on from a state of tensors of the same shapes."""
        for name, tensors in self.state().items():
            for tensor, held in zip(tensors, state[name], strict=True):
                tensor.copy_(held)
