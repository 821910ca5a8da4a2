"""Surface logits against probability theory and automatic differentiation."""

import torch

from schemas.options import NetworkOptions
from schemas.vocabulary import Structure
from worker.reconstruction.network import TissueField
from worker.reconstruction.surface_logits import SurfaceLogits
from worker.reconstruction.tissues import partition

CLASSES = partition(list(Structure))


def test_sigmoid_of_a_surface_is_the_probability_of_its_classes() -> None:
    z = torch.randn(50, CLASSES.class_count, generator=torch.Generator().manual_seed(1))
    encloses = torch.as_tensor(CLASSES.encloses, dtype=torch.float32)
    expected = torch.softmax(z, dim=1) @ encloses.t()
    torch.testing.assert_close(torch.sigmoid(SurfaceLogits(CLASSES)(z)), expected)


def test_walls_enclose_cavities_for_any_network() -> None:
    z = 10.0 * torch.randn(200, CLASSES.class_count, generator=torch.Generator().manual_seed(2))
    logits = dict(zip(CLASSES.surfaces, SurfaceLogits(CLASSES)(z).t(), strict=True))
    assert torch.all(logits[Structure.LV_EPI] >= logits[Structure.LV_ENDO])
    assert torch.all(logits[Structure.EPI] >= logits[Structure.RV_EPI])
    both = (logits[Structure.LV_EPI] > 0) & (logits[Structure.RV_EPI] > 0)
    assert not both.any()


def test_gradients_agree_with_automatic_differentiation() -> None:
    generator = torch.Generator().manual_seed(3)
    field = TissueField(CLASSES.class_count, NetworkOptions(width=16, depth=3), generator)
    surface_logits = SurfaceLogits(CLASSES)
    points = torch.rand(20, 3, generator=generator, requires_grad=True)
    logits = surface_logits(field(points))
    same, gradients = surface_logits.with_gradient(*field.with_jacobian(points))
    torch.testing.assert_close(same, logits)
    for column in range(logits.shape[1]):
        (expected,) = torch.autograd.grad(logits[:, column].sum(), points, retain_graph=True)
        torch.testing.assert_close(gradients[:, :, column].t(), expected, rtol=1e-4, atol=1e-4)
