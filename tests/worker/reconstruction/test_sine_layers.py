"""Values, derivatives by position and gradients of both, against differentiation by others."""

from functools import partial

import pytest
import torch
from torch import Tensor

from schemas.options import NetworkOptions
from worker.reconstruction.network import TissueField
from worker.reconstruction.sine_layers import Layers, SineLayers

DEPTHS = pytest.mark.parametrize("depth", [1, 2, 4])


def layers_of(depth: int, width: int = 5, classes: int = 3, seed: int = 0) -> Layers:
    generator = torch.Generator().manual_seed(seed)
    draw = partial(torch.randn, generator=generator, dtype=torch.float64)
    return (
        draw(3, width),
        draw(depth - 1, width, width) / width**0.5,
        draw(depth, width),
        draw(width, classes),
        draw(classes),
    )


def points_of(count: int, seed: int = 1) -> Tensor:
    generator = torch.Generator().manual_seed(seed)
    return 2.0 * torch.rand(count, 3, generator=generator, dtype=torch.float64) - 1.0


def plainly(points: Tensor, *layers: Tensor) -> Tensor:
    """The formula itself."""
    first, hidden, biases, last, last_bias = layers
    values = torch.sin(points @ first + biases[0])
    for weight, bias in zip(hidden, biases[1:], strict=True):
        values = torch.sin(values @ weight + bias)
    return values @ last + last_bias


@DEPTHS
@pytest.mark.parametrize("count", [0, 3, 7])
def test_the_gradient_is_that_of_differences(depth: int, count: int) -> None:
    inputs = [t.requires_grad_() for t in (points_of(7), *layers_of(depth))]

    def both(points: Tensor, *layers: Tensor) -> tuple[Tensor, Tensor]:
        return SineLayers.apply(points, count, *layers)

    assert torch.autograd.gradcheck(both, inputs, check_undefined_grad=False)


@DEPTHS
@pytest.mark.parametrize("count", [0, 3, 7])
def test_the_gradient_is_that_of_automatic_differentiation_twice(depth: int, count: int) -> None:
    inputs = [t.requires_grad_() for t in (points_of(7), *layers_of(depth))]

    def loss(logits: Tensor, jacobian: Tensor) -> Tensor:
        return torch.exp(0.1 * logits).sum() + (jacobian**2).sum()

    logits = plainly(*inputs)
    columns = [
        torch.autograd.grad(column.sum(), inputs[0], create_graph=True)[0][:count]
        for column in logits.unbind(1)
    ]
    jacobian = torch.stack(columns, dim=2).transpose(0, 1)
    expected = torch.autograd.grad(loss(logits, jacobian), inputs, materialize_grads=True)
    found = torch.autograd.grad(loss(*SineLayers.apply(inputs[0], count, *inputs[1:])), inputs)
    torch.testing.assert_close(found, expected)


@DEPTHS
def test_the_jacobian_is_that_of_differences(depth: int) -> None:
    points, layers, step = points_of(20), layers_of(depth), 1e-5
    logits, jacobian = SineLayers.apply(points, 20, *layers)
    torch.testing.assert_close(logits, plainly(points, *layers))
    for axis, offset in enumerate(step * torch.eye(3, dtype=torch.float64)):
        ahead, behind = plainly(points + offset, *layers), plainly(points - offset, *layers)
        torch.testing.assert_close(
            jacobian[axis], (ahead - behind) / (2.0 * step), rtol=1e-7, atol=1e-7
        )


@DEPTHS
def test_derivatives_are_of_the_first_points_and_change_no_value(depth: int) -> None:
    points, layers = points_of(9), layers_of(depth)
    all_logits, all_derivatives = SineLayers.apply(points, 9, *layers)
    for count in (0, 1, 4):
        logits, derivatives = SineLayers.apply(points, count, *layers)
        assert derivatives.shape == (3, count, 3)
        torch.testing.assert_close(logits, all_logits)
        torch.testing.assert_close(derivatives, all_derivatives[:, :count])


@DEPTHS
def test_logits_are_those_of_the_field(depth: int) -> None:
    options = NetworkOptions(width=16, depth=depth)
    generator = torch.Generator().manual_seed(2)
    field = TissueField(4, options, generator)
    points = torch.rand(50, 3, generator=generator)
    logits, jacobian = field.with_jacobian(points, 5)
    torch.testing.assert_close(logits, field(points))
    assert jacobian.shape == (3, 5, 4)


def test_no_gradient_is_taken_by_points_that_ask_for_none() -> None:
    points, layers = points_of(4), [t.requires_grad_() for t in layers_of(2)]
    logits, jacobian = SineLayers.apply(points, 2, *layers)
    (logits.sum() + jacobian.sum()).backward()
    assert points.grad is None
    assert all(layer.grad is not None for layer in layers)


def test_a_second_differentiation_is_refused() -> None:
    inputs = [t.requires_grad_() for t in (points_of(4), *layers_of(2))]
    logits, _ = SineLayers.apply(inputs[0], 2, *inputs[1:])
    (by_points,) = torch.autograd.grad((logits**2).sum(), inputs[0], create_graph=True)
    with pytest.raises(RuntimeError, match="once_differentiable"):
        by_points.sum().backward()
