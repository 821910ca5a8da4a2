"""A field as plain functions: chunks change nothing, gradients are the field's."""

import numpy as np
import pytest
import torch

from schemas.options import NetworkOptions
from schemas.vocabulary import Structure
from worker.observer import Cancelled, Unobserved
from worker.reconstruction.field_evaluation import FieldEvaluation
from worker.reconstruction.network import TissueField
from worker.reconstruction.surface_logits import SurfaceLogits
from worker.reconstruction.tissues import partition


@pytest.fixture
def evaluation() -> FieldEvaluation:
    classes = partition([Structure.LV_ENDO, Structure.LV_EPI])
    generator = torch.Generator().manual_seed(0)
    field = TissueField(classes.class_count, NetworkOptions(width=16), generator)
    return FieldEvaluation(field, SurfaceLogits(classes), Unobserved())


def test_many_points_are_as_each_alone(evaluation: FieldEvaluation) -> None:
    points = np.random.default_rng(0).uniform(-1, 1, (40000, 3))
    together = evaluation.logits(points)
    assert together.shape == (40000, 2)
    picked = [0, 16383, 16384, 39999]
    np.testing.assert_allclose(together[picked], evaluation.logits(points[picked]), atol=1e-5)


def test_gradients_agree_with_differences(evaluation: FieldEvaluation) -> None:
    points = np.random.default_rng(1).uniform(-1, 1, (50, 3))
    for surface in (0, 1):
        logits, gradients = evaluation.logits_and_gradient(points, surface)
        np.testing.assert_allclose(logits, evaluation.logits(points)[:, surface], atol=1e-5)
        for axis in range(3):
            step = 1e-2 * np.eye(3)[axis]
            ahead = evaluation.logits(points + step)[:, surface]
            behind = evaluation.logits(points - step)[:, surface]
            np.testing.assert_allclose(
                gradients[:, axis], (ahead - behind) / 2e-2, rtol=0.05, atol=0.05
            )


def test_second_derivatives_agree_with_differences_of_the_first(
    evaluation: FieldEvaluation,
) -> None:
    points = np.random.default_rng(2).uniform(-1, 1, (50, 3))
    for surface in (0, 1):
        gradients, hessians = evaluation.gradient_and_hessian(points, surface)
        np.testing.assert_allclose(
            gradients, evaluation.logits_and_gradient(points, surface)[1], rtol=1e-3, atol=1e-3
        )
        np.testing.assert_allclose(hessians, np.swapaxes(hessians, 1, 2), rtol=1e-3, atol=1e-3)
        for axis in range(3):
            step = 1e-2 * np.eye(3)[axis]
            _, ahead = evaluation.logits_and_gradient(points + step, surface)
            _, behind = evaluation.logits_and_gradient(points - step, surface)
            np.testing.assert_allclose(
                hessians[:, axis], (ahead - behind) / 2e-2, rtol=0.05, atol=0.2
            )


def test_no_points_no_logits(evaluation: FieldEvaluation) -> None:
    assert evaluation.logits(np.empty((0, 3))).shape == (0, 2)


class Impatient(Unobserved):
    """Asks to stop at the second look."""

    def __init__(self) -> None:
        self.looks = 0

    def is_cancelled(self) -> bool:
        self.looks += 1
        return self.looks > 1


@pytest.mark.parametrize(("width", "depth", "chunk"), [(64, 4, 16384), (512, 4, 8192)])
def test_it_stops_between_chunks_that_are_smaller_for_larger_networks(
    width: int, depth: int, chunk: int
) -> None:
    classes = partition([Structure.LV_ENDO])
    options = NetworkOptions(width=width, depth=depth)
    field = TissueField(classes.class_count, options, torch.Generator().manual_seed(0))
    logits_of = FieldEvaluation(field, SurfaceLogits(classes), Impatient()).logits
    assert logits_of(np.zeros((4, 3))).shape == (4, 1)
    again = FieldEvaluation(field, SurfaceLogits(classes), Impatient())
    with pytest.raises(Cancelled):
        again.logits_and_gradient(np.zeros((chunk + 1, 3)), 0)
