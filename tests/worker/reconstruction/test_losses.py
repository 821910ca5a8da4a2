"""The two loss terms against their formulas."""

import math

import torch

from worker.reconstruction.losses import bce, hinge


def test_bce_is_the_papers_equation_3() -> None:
    f = torch.tensor([[0.9, 0.2], [0.4, 0.7]])
    m = torch.tensor([[1.0, 0.0], [0.5, 1.0]])
    expected = -(m * f.log() + (1 - m) * (1 - f).log()).mean()
    torch.testing.assert_close(bce(torch.logit(f), m, torch.ones_like(m)), expected)


def test_bce_counts_known_entries_alone() -> None:
    logits, targets = torch.tensor([[3.0, -50.0]]), torch.tensor([[1.0, 1.0]])
    known = torch.tensor([[1.0, 0.0]])
    torch.testing.assert_close(
        bce(logits, targets, known), torch.tensor(math.log1p(math.exp(-3.0)))
    )


def test_bce_without_knowledge_is_zero() -> None:
    assert bce(torch.ones(3, 2), torch.ones(3, 2), torch.zeros(3, 2)) == 0.0


def test_weights_are_relative() -> None:
    generator = torch.Generator().manual_seed(0)
    logits, targets, weights = torch.rand(3, 8, 2, generator=generator)
    torch.testing.assert_close(bce(logits, targets, 7.0 * weights), bce(logits, targets, weights))


def test_a_weight_of_three_is_as_being_there_three_times() -> None:
    logits, targets = torch.tensor([[1.0], [-2.0]]), torch.tensor([[0.5], [1.0]])
    weights = torch.tensor([[3.0], [1.0]])
    thrice, rows = torch.ones(4, 1), [0, 0, 0, 1]
    torch.testing.assert_close(
        bce(logits, targets, weights), bce(logits[rows], targets[rows], thrice)
    )


def test_boundary_targets_pull_the_logit_to_zero() -> None:
    logits = torch.tensor([[2.0]], requires_grad=True)
    bce(logits, torch.tensor([[0.5]]), torch.ones(1, 1)).backward()
    assert logits.grad is not None
    assert logits.grad.item() > 0.0


def test_hinge_is_the_excess_of_the_slope() -> None:
    gradients = torch.tensor([[[3.0], [0.0]], [[4.0], [1.0]], [[0.0], [0.0]]])
    torch.testing.assert_close(hinge(gradients, 2.0), torch.tensor((3.0 + 0.0) / 2))
    assert hinge(gradients, 5.1) == 0.0
