"""A field as plain functions: chunks change nothing, gradients are the field's."""

import numpy as np
import pytest
import torch

from schemas.options import NetworkOptions
from schemas.vocabulary import Structure
from worker.reconstruction.field_evaluation import FieldEvaluation
from worker.reconstruction.network import TissueField
from worker.reconstruction.surface_logits import SurfaceLogits
from worker.reconstruction.tissues import partition


@pytest.fixture
def evaluation() -> FieldEvaluation:
    classes = partition([Structure.LV_ENDO, Structure.LV_EPI])
    generator = torch.Generator().manual_seed(0)
    field = TissueField(classes.class_count, NetworkOptions(width=16), generator)
    return FieldEvaluation(field, SurfaceLogits(classes))


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


def test_no_points_no_logits(evaluation: FieldEvaluation) -> None:
    assert evaluation.logits(np.empty((0, 3))).shape == (0, 2)
