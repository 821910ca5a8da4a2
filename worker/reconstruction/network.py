"""The tissue field: one multilayer perceptron from a point to the logits of all classes.

Hidden layers are sines (SIREN, arXiv 2006.09661). Inputs are unit coordinates; the field of a
surface is the sigmoid of `surface_logits`.
"""

import itertools
import math

import torch
from torch import Tensor, nn

from schemas.options import NetworkOptions


class TissueField(nn.Module):
    """z: R3 -> class logits."""

    def __init__(
        self, class_count: int, options: NetworkOptions, generator: torch.Generator
    ) -> None:
        super().__init__()
        widths = [3] + [options.width] * options.depth + [class_count]
        self.weights = nn.ParameterList()
        self.biases = nn.ParameterList()
        for layer, (fan_in, fan_out) in enumerate(itertools.pairwise(widths)):
            # The first layer sets the frequencies; later ones keep activations' variance.
            bound = options.first_frequency / fan_in if layer == 0 else math.sqrt(6.0 / fan_in)
            self.weights.append(nn.Parameter(_uniform((fan_out, fan_in), bound, generator)))
            phase = math.pi if layer == 0 else 1.0 / math.sqrt(fan_in)
            self.biases.append(nn.Parameter(_uniform((fan_out,), phase, generator)))

    def forward(self, points_unit: Tensor) -> Tensor:
        """(n, 3) unit coordinates to (n, classes) logits."""
        hidden = points_unit
        for weight, bias in zip(self.weights[:-1], self.biases[:-1], strict=True):
            hidden = torch.sin(torch.addmm(bias, hidden, weight.t()))
        return torch.addmm(self.biases[-1], hidden, self.weights[-1].t())

    def with_jacobian(self, points_unit: Tensor) -> tuple[Tensor, Tensor]:
        """Logits (n, classes) and their derivatives by position (3, n, classes).

        The derivatives are carried forward layer by layer, so that a loss on them needs one
        backward pass and not a second differentiation of the first.
        """
        hidden = points_unit
        tangent = torch.eye(3).unsqueeze(1).expand(3, len(points_unit), 3)
        for weight, bias in zip(self.weights[:-1], self.biases[:-1], strict=True):
            phase = torch.addmm(bias, hidden, weight.t())
            hidden = torch.sin(phase)
            tangent = torch.cos(phase) * (tangent @ weight.t())
        logits = torch.addmm(self.biases[-1], hidden, self.weights[-1].t())
        return logits, tangent @ self.weights[-1].t()


def _uniform(shape: tuple[int, ...], bound: float, generator: torch.Generator) -> Tensor:
    return (2.0 * torch.rand(shape, generator=generator) - 1.0) * bound
