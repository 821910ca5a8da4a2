"""Derivatives written out, against automatic differentiation."""

import pytest
import torch

from schemas.options import NetworkOptions
from schemas.vocabulary import Structure
from worker.reconstruction.field_derivatives import (
    class_logits,
    gradient_and_hessian,
    logit_and_gradient,
)
from worker.reconstruction.network import TissueField
from worker.reconstruction.surface_logits import SurfaceLogits
from worker.reconstruction.tissues import partition

CLASSES = partition([Structure.LV_ENDO, Structure.LV_EPI, Structure.RV_ENDO])


@pytest.fixture(params=[(16, 4), (24, 1), (8, 2)])
def field(request: pytest.FixtureRequest) -> TissueField:
    width, depth = request.param
    options = NetworkOptions.model_construct(width=width, depth=depth, first_frequency=6.0)
    return TissueField(CLASSES.class_count, options, torch.Generator().manual_seed(0))


def some_points(count: int) -> torch.Tensor:
    return 2.0 * torch.rand(count, 3, generator=torch.Generator().manual_seed(1)) - 1.0


def differentiated(
    field: TissueField, points: torch.Tensor, surface: int
) -> tuple[torch.Tensor, torch.Tensor, torch.Tensor]:
    inside = torch.as_tensor(CLASSES.encloses[surface], dtype=torch.bool)

    def logit(point: torch.Tensor) -> torch.Tensor:
        z = field(point[None])[0]
        return torch.logsumexp(z[inside], 0) - torch.logsumexp(z[~inside], 0)

    every = [
        (
            logit(point),
            torch.autograd.functional.jacobian(logit, point),
            torch.autograd.functional.hessian(logit, point),
        )
        for point in points
    ]
    logits, gradients, hessians = (torch.stack(part) for part in zip(*every, strict=True))
    return logits.detach(), gradients, hessians


def test_class_logits_are_what_the_field_gives(field: TissueField) -> None:
    points = some_points(40)
    torch.testing.assert_close(class_logits(field, points), field(points).detach())


@pytest.mark.parametrize("surface", range(3))
def test_they_are_those_of_automatic_differentiation(field: TissueField, surface: int) -> None:
    points, surface_logits = some_points(40), SurfaceLogits(CLASSES)
    expected, expected_gradient, expected_hessian = differentiated(field, points, surface)
    logit, gradient = logit_and_gradient(field, surface_logits, points, surface)
    torch.testing.assert_close(logit, expected, rtol=1e-4, atol=1e-4)
    torch.testing.assert_close(gradient, expected_gradient, rtol=1e-3, atol=1e-3)
    again, hessian = gradient_and_hessian(field, surface_logits, points, surface)
    torch.testing.assert_close(again, gradient, rtol=1e-4, atol=1e-4)
    torch.testing.assert_close(hessian, expected_hessian, rtol=1e-3, atol=5e-3)
    torch.testing.assert_close(hessian, hessian.transpose(1, 2), rtol=1e-3, atol=5e-3)
