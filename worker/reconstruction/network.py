"""The tissue field: one multilayer perceptron from a point to the logits of all classes.

Hidden layers are sines (SIREN, arXiv 2006.09661). Inputs are unit coordinates; the field of a
surface is the sigmoid of `surface_logits`.
"""

import math
from copy import deepcopy

import torch
from torch import Tensor, nn

from schemas.options import NetworkOptions
from worker.reconstruction.affine_motion import AffineMotion
from worker.reconstruction.sine_layers import SineLayers


class TissueField(nn.Module):
    """z: R3 -> class logits."""

    def __init__(
        self, class_count: int, options: NetworkOptions, generator: torch.Generator
    ) -> None:
        super().__init__()
        width, depth = options.width, options.depth

        def uniform(shape: tuple[int, ...], bound: float) -> nn.Parameter:
            return nn.Parameter((2.0 * torch.rand(shape, generator=generator) - 1.0) * bound)

        # The first layer sets the frequencies; later ones keep activations' variance.
        self.first = uniform((3, width), options.first_frequency / 3.0)
        self.hidden = uniform((depth - 1, width, width), math.sqrt(6.0 / width))
        self.last = uniform((width, class_count), math.sqrt(6.0 / width))
        phases = uniform((1, width), math.pi)
        biases = uniform((depth - 1, width), 1.0 / math.sqrt(width))
        self.biases = nn.Parameter(torch.cat([phases, biases]).detach())
        self.last_bias = uniform((class_count,), 1.0 / math.sqrt(width))

    def forward(self, points_unit: Tensor) -> Tensor:
        """(n, 3) unit coordinates to (n, classes) logits."""
        hidden = torch.addmm(self.biases[0], points_unit, self.first).sin()
        for bias, weight in zip(self.biases[1:], self.hidden, strict=True):
            hidden = torch.addmm(bias, hidden, weight).sin()
        return torch.addmm(self.last_bias, hidden, self.last)

    def with_jacobian(self, points_unit: Tensor, count: int) -> tuple[Tensor, Tensor]:
        """Logits (n, classes), and derivatives by position (3, count, classes) of the first ones.

        Derivatives are carried forward layer by layer, so that a loss on them needs one backward
        pass and not a second differentiation of the first.
        """
        layers = (self.first, self.hidden, self.biases, self.last, self.last_bias)
        logits, jacobian = SineLayers.apply(  # type: ignore[no-untyped-call]
            points_unit, count, *layers
        )
        return logits, jacobian

    @torch.no_grad()
    def moved(self, motion: AffineMotion) -> "TissueField":
        """The field carried along: its logits at a moved point are those at the point before.

        The first layer is linear in the point, so it takes the motion up whole.
        """
        there = deepcopy(self)
        back = motion.inverse()
        there.first.copy_(torch.as_tensor(back.matrix.T, dtype=torch.float32) @ self.first)
        there.biases[0] += torch.as_tensor(back.offset, dtype=torch.float32) @ self.first
        return there
