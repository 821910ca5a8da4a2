"""Matrix products are counted as they are."""

import pytest
import torch

from benchmarks.speed import Products, UntilMeshing, flop, products_s
from schemas.job import Progress, Stage


def test_products_forward_and_backward_are_noted_until_meshing() -> None:
    until = UntilMeshing()
    left = torch.ones(5, 3, requires_grad=True)
    right = torch.ones(3, 2, requires_grad=True)
    with Products(until) as products:
        torch.addmm(torch.ones(2), left, right).sum().backward()
        until.advanced(Progress(fraction=0.5, stage=Stage.FITTING))
        torch.bmm(torch.ones(4, 1, 2), torch.ones(4, 2, 6))
        until.advanced(Progress(fraction=0.9, stage=Stage.MESHING))
        torch.mm(torch.ones(7, 7), torch.ones(7, 7))
    assert sorted(products.shapes) == sorted(
        [((5, 3), (3, 2)), ((3, 5), (5, 2)), ((5, 2), (2, 3)), ((4, 1, 2), (4, 2, 6))]
    )
    assert until.is_cancelled()


def test_a_product_takes_a_multiplication_and_an_addition_for_each_term() -> None:
    assert flop([((5, 3), (3, 2))]) == 2 * 5 * 3 * 2
    assert flop([((4, 1, 2), (4, 2, 6))] * 3) == 3 * 4 * 2 * 1 * 2 * 6


def test_the_same_products_can_be_done_again() -> None:
    assert products_s([((5, 3), (3, 2)), ((4, 1, 2), (4, 2, 6))]) > 0.0
    with pytest.raises(RuntimeError):
        products_s([((5, 3), (4, 2))])
