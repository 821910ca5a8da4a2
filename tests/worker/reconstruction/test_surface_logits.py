"""Surface logits against probability theory and automatic differentiation."""

import pytest
import torch
from torch import Tensor

from schemas.options import NetworkOptions
from schemas.vocabulary import Structure
from worker.reconstruction.network import TissueField
from worker.reconstruction.surface_logits import SurfaceLogits, _UnionLogits
from worker.reconstruction.tissues import partition

CLASSES = partition(list(Structure))


def random_logits(count: int, scale: float, seed: int) -> Tensor:
    generator = torch.Generator().manual_seed(seed)
    return scale * torch.randn(count, CLASSES.class_count, generator=generator)


def as_defined(class_logits: Tensor) -> Tensor:
    """logsumexp over the classes within, minus logsumexp over those without."""
    columns = []
    for row in torch.as_tensor(CLASSES.encloses):
        within, without = class_logits[:, row], class_logits[:, ~row]
        columns.append(torch.logsumexp(within, 1) - torch.logsumexp(without, 1))
    return torch.stack(columns, dim=1)


def test_sigmoid_of_a_surface_is_the_probability_of_its_classes() -> None:
    z = random_logits(50, 1.0, 1)
    encloses = torch.as_tensor(CLASSES.encloses, dtype=torch.float32)
    expected = torch.softmax(z, dim=1) @ encloses.t()
    torch.testing.assert_close(torch.sigmoid(SurfaceLogits(CLASSES)(z)), expected)


@pytest.mark.parametrize("scale", [0.1, 1.0, 10.0])
def test_they_are_differences_of_logsumexp(scale: float) -> None:
    z = random_logits(500, scale, 2)
    torch.testing.assert_close(SurfaceLogits(CLASSES)(z), as_defined(z), rtol=1e-4, atol=1e-5)


@pytest.mark.parametrize("scale", [0.1, 1.0, 10.0, 1000.0])
def test_walls_enclose_cavities_for_any_network(scale: float) -> None:
    z = random_logits(2000, scale, 3)
    logits = dict(zip(CLASSES.surfaces, SurfaceLogits(CLASSES)(z).t(), strict=True))
    assert torch.all(logits[Structure.LV_EPI] >= logits[Structure.LV_ENDO])
    assert torch.all(logits[Structure.RV_EPI] >= logits[Structure.RV_ENDO])
    assert torch.all(logits[Structure.EPI] >= logits[Structure.RV_EPI])
    assert torch.all(logits[Structure.EPI] >= logits[Structure.LV_EPI])
    both = (logits[Structure.LV_EPI] > 0) & (logits[Structure.RV_EPI] > 0)
    assert not both.any()


def test_the_gradient_is_that_of_differences() -> None:
    z = random_logits(20, 3.0, 4).double().requires_grad_()
    inside = torch.as_tensor(CLASSES.encloses.T, dtype=torch.float64)
    assert torch.autograd.gradcheck(
        lambda logits: _UnionLogits.apply(logits, inside, 1 - inside), z
    )


@pytest.mark.parametrize("scale", [0.1, 1.0, 10.0])
def test_the_gradient_is_that_of_differences_of_logsumexp(scale: float) -> None:
    z = random_logits(100, scale, 5).requires_grad_()
    weights = torch.randn(100, len(CLASSES.surfaces), generator=torch.Generator().manual_seed(6))
    found, expected = (
        torch.autograd.grad((logits_of(z) * weights).sum(), z)[0]
        for logits_of in (SurfaceLogits(CLASSES), as_defined)
    )
    torch.testing.assert_close(found, expected, rtol=1e-4, atol=1e-5)


def test_gradients_by_position_agree_with_automatic_differentiation() -> None:
    generator = torch.Generator().manual_seed(3)
    field = TissueField(CLASSES.class_count, NetworkOptions(width=16, depth=3), generator)
    surface_logits = SurfaceLogits(CLASSES)
    points = torch.rand(20, 3, generator=generator, requires_grad=True)
    logits = surface_logits(field(points))
    gradients = surface_logits.gradient(*field.with_jacobian(points, 20))
    for column in range(logits.shape[1]):
        (expected,) = torch.autograd.grad(logits[:, column].sum(), points, retain_graph=True)
        torch.testing.assert_close(gradients[:, :, column].t(), expected, rtol=1e-4, atol=1e-4)


def test_a_loss_on_gradients_by_position_reaches_the_class_logits() -> None:
    z = random_logits(20, 1.0, 7)
    jacobian = torch.randn(3, 20, CLASSES.class_count, generator=torch.Generator().manual_seed(8))

    def as_differentiated(class_logits: Tensor, derivatives: Tensor) -> Tensor:
        by_classes = [
            torch.autograd.grad(column.sum(), class_logits, create_graph=True)[0]
            for column in as_defined(class_logits).unbind(1)
        ]
        return torch.stack([(derivatives * by).sum(2) for by in by_classes], dim=2)

    inputs = [z.requires_grad_(), jacobian.requires_grad_()]
    found, expected = (
        torch.autograd.grad((gradient_of(*inputs) ** 2).sum(), inputs)
        for gradient_of in (SurfaceLogits(CLASSES).gradient, as_differentiated)
    )
    torch.testing.assert_close(found, expected, rtol=1e-4, atol=1e-4)


@pytest.mark.parametrize("scale", [1e2, 1e4, 1e30])
def test_extreme_logits_stay_finite_and_so_do_their_gradients(scale: float) -> None:
    z = random_logits(200, scale, 9).requires_grad_()
    surface_logits = SurfaceLogits(CLASSES)
    logits = surface_logits(z)
    assert logits.isfinite().all()
    assert logits.abs().max() < 70.0
    # Signs are those of the exact ones.
    clear = as_defined(z).abs() > 1e-3
    assert torch.equal(logits[clear] > 0.0, as_defined(z)[clear] > 0.0)
    logits.sum().backward()
    assert z.grad is not None
    assert z.grad.isfinite().all()
    assert z.grad.abs().max() <= len(CLASSES.surfaces) + 1e-3
    jacobian = torch.ones(3, 200, CLASSES.class_count)
    assert surface_logits.gradient(z, jacobian).isfinite().all()


@pytest.mark.parametrize("surface", range(len(CLASSES.surfaces)))
def test_one_alone_is_as_among_all(surface: int) -> None:
    z = random_logits(200, 3.0, 5).requires_grad_()
    logits = SurfaceLogits(CLASSES)
    logit, slope = logits.with_slope(z, surface)
    torch.testing.assert_close(logit, logits(z)[:, surface], rtol=1e-4, atol=1e-5)
    (expected,) = torch.autograd.grad(as_defined(z)[:, surface].sum(), z)
    torch.testing.assert_close(slope, expected, rtol=1e-4, atol=1e-5)


@pytest.mark.parametrize("surface", range(len(CLASSES.surfaces)))
def test_the_slope_of_one_changes_as_its_differences_do(surface: int) -> None:
    z, along = random_logits(200, 3.0, 5), random_logits(200, 1.0, 6)
    logits, step = SurfaceLogits(CLASSES), 1e-2
    ahead, behind = (logits.with_slope(z + s * along, surface)[1] for s in (step, -step))
    (found,) = logits.slope_along(z, along[None], surface)
    torch.testing.assert_close(found, (ahead - behind) / (2.0 * step), rtol=1e-2, atol=1e-3)
