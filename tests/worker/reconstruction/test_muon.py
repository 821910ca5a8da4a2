"""Orthogonalised momentum: directions kept, lengths evened, downhill."""

import pytest
import torch
from torch import nn

from worker.reconstruction.muon import Muon, orthogonalised


def random_stack(count: int = 3, n: int = 32, seed: int = 0) -> torch.Tensor:
    """Matrices of known condition: singular values from 1 to 10, at any scale."""
    generator = torch.Generator().manual_seed(seed)
    u, v = (torch.linalg.qr(torch.randn(count, n, n, generator=generator))[0] for _ in range(2))
    sizes = torch.linspace(1.0, 10.0, n)
    return u @ torch.diag(sizes) @ v.transpose(1, 2)


@pytest.mark.parametrize("scale", [1e-6, 1.0, 1e6])
def test_singular_vectors_are_kept_and_values_come_near_one(scale: float) -> None:
    matrices = scale * random_stack()
    u, _, vt = torch.linalg.svd(matrices)
    rotated = u.transpose(1, 2) @ orthogonalised(matrices) @ vt.transpose(1, 2)
    sizes = torch.diagonal(rotated, dim1=1, dim2=2)
    assert sizes.min() > 0.6
    assert sizes.max() < 1.3
    torch.testing.assert_close(rotated, torch.diag_embed(sizes), rtol=0.0, atol=1e-4)


def test_each_matrix_is_alone() -> None:
    matrices = random_stack()
    for index, matrix in enumerate(matrices):
        alone = orthogonalised(matrix[None])[0]
        torch.testing.assert_close(orthogonalised(matrices)[index], alone)


def test_nothing_comes_of_nothing() -> None:
    assert not orthogonalised(torch.zeros(2, 4, 4)).any()


def test_steps_descend_a_quadratic_however_ill_conditioned() -> None:
    target = random_stack(seed=1) / 10.0
    stretch = torch.logspace(0.0, 2.0, 32)[:, None]
    matrices = nn.Parameter(torch.zeros_like(target))
    muon = Muon(matrices)
    losses = []
    for step in range(200):
        loss = 0.5 * (stretch * (matrices - target) ** 2).sum()
        losses.append(loss.item())
        loss.backward()
        muon.step(0.02 * (1.0 - step / 200))
    assert losses[1] < losses[0]
    assert losses[-1] < 1e-3 * losses[0]


def test_a_step_is_as_long_as_adams() -> None:
    matrices = nn.Parameter(torch.zeros(3, 32, 32))
    matrices.grad = random_stack()
    Muon(matrices).step(0.01)
    rms = matrices.detach().square().mean(dim=(1, 2)).sqrt()
    torch.testing.assert_close(rms, torch.full((3,), 0.2 * 0.01), rtol=0.3, atol=0.0)


def test_the_gradient_is_let_go_of() -> None:
    matrices = nn.Parameter(torch.zeros(1, 4, 4))
    matrices.grad = torch.eye(4)[None]
    Muon(matrices).step(0.1)
    assert matrices.grad is None


def test_a_step_without_a_gradient_is_an_error() -> None:
    muon = Muon(nn.Parameter(torch.zeros(1, 4, 4)))
    with pytest.raises(ValueError, match="no gradient; call backward first"):
        muon.step(0.1)
