"""A sine network with its derivatives by position, and the gradient of both, in closed form.

Automatic differentiation would record some eighty operations a step and allocate as many arrays;
here values and derivatives share each layer's matrix product, forward and back.
"""

from typing import Any

import torch
from torch import Tensor
from torch.autograd.function import once_differentiable

Layers = tuple[Tensor, Tensor, Tensor, Tensor, Tensor]
"""first (3, w), hidden (depth - 1, w, w), biases (depth, w), last (w, classes), last bias."""


class SineLayers(torch.autograd.Function):
    """`apply(points, count, *layers)`: logits (n, c), and those of the first `count` by position.

    sin(x first + b0), then sin(h hidden[l] + b[l]) a layer, then h last + last bias. The second
    result is (3, count, c): d logits / d x, d y, d z of the first `count` points.
    """

    @staticmethod
    def forward(ctx: Any, points: Tensor, count: int, *layers: Tensor) -> tuple[Tensor, Tensor]:
        first, hidden, biases, last, last_bias = layers
        n, width = len(points), first.shape[1]
        # Rows: n values, then count derivatives by x, by y, by z.
        phases = torch.addmm(biases[0], points, first)
        slopes = first.unsqueeze(1)
        kept: list[tuple[Tensor, Tensor, Tensor]] = []
        for depth in range(len(biases)):
            if depth > 0:
                rows = kept[-1][0] @ hidden[depth - 1]
                phases, slopes = rows[:n].add_(biases[depth]), rows[n:].view(3, count, width)
            cosines = torch.cos(phases)
            rows = torch.empty(n + 3 * count, width, dtype=points.dtype)
            torch.sin(phases, out=rows[:n])
            torch.mul(cosines[:count], slopes, out=rows[n:].view(3, count, width))
            kept.append((rows, cosines, slopes))
        outputs = kept[-1][0] @ last
        ctx.points, ctx.count, ctx.layers, ctx.kept = points, count, layers, kept
        return outputs[:n] + last_bias, outputs[n:].view(3, count, last.shape[1])

    @staticmethod
    @once_differentiable
    def backward(
        ctx: Any, by_logits: Tensor, by_jacobian: Tensor
    ) -> tuple[Tensor | None, None, Tensor, Tensor, Tensor, Tensor, Tensor]:
        first, hidden, biases, last, _ = ctx.layers
        points, count, kept = ctx.points, ctx.count, ctx.kept
        n, width = len(points), first.shape[1]
        by_hidden, by_biases = torch.empty_like(hidden), torch.empty_like(biases)
        by_rows = torch.cat([by_logits, by_jacobian.flatten(0, 1)])
        by_last = kept[-1][0].t() @ by_rows
        onward = last
        for depth in range(len(biases) - 1, -1, -1):
            rows, cosines, slopes = kept[depth]
            by_rows = by_rows @ onward.t()
            by_phases, by_slopes = by_rows[:n], by_rows[n:].view(3, count, width)
            by_cosines = (slopes * by_slopes).sum(0)
            by_slopes *= cosines[:count]
            by_phases *= cosines
            by_phases[:count].addcmul_(rows[:count], by_cosines, value=-1.0)
            torch.sum(by_phases, 0, out=by_biases[depth])
            if depth > 0:
                onward = hidden[depth - 1]
                torch.mm(kept[depth - 1][0].t(), by_rows, out=by_hidden[depth - 1])
        by_first = torch.addmm(by_slopes.sum(1), points.t(), by_phases)
        by_points = by_phases @ first.t() if ctx.needs_input_grad[0] else None
        return by_points, None, by_first, by_hidden, by_biases, by_last, by_logits.sum(0)
