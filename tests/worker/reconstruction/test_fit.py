"""The fit: what its options weigh, and what it reports on the way."""

import numpy as np
import pytest
import torch

from schemas.options import Options
from schemas.vocabulary import Structure
from worker.observer import Unobserved
from worker.reconstruction.alignment import SliceShifts
from worker.reconstruction.fit import FieldFit, fit_field
from worker.reconstruction.hull import inflated_hull
from worker.reconstruction.network import TissueField
from worker.reconstruction.normalisation import normalise
from worker.reconstruction.samples import LabelledSamples
from worker.reconstruction.sampling import level_radius, sample_level
from worker.reconstruction.shift_evidence import no_evidence
from worker.reconstruction.stacking import build_stack
from worker.reconstruction.tissues import partition
from worker.reconstruction.unit_stack import UnitStack

CLASSES = partition([Structure.LV_ENDO, Structure.LV_EPI])


@pytest.fixture(scope="module")
def stack(concentric_spheres) -> UnitStack:
    study = concentric_spheres()
    return normalise(build_stack(study, study.frames[0]))[0]


def options_with(**loss: float) -> Options:
    return Options.model_validate(
        {
            "levels": 2,
            "iterations_per_level": 60,
            "optimizer": {"samples_per_step": 1024},
            "network": {"width": 32, "depth": 2},
            "loss": loss,
        }
    )


def fitted(stack: UnitStack, options: Options, start: TissueField | None = None) -> FieldFit:
    hull = inflated_hull(stack.points_unit, options.sampling.hull_inflation)
    rng = np.random.default_rng(0)

    def samples_of(level: int) -> LabelledSamples:
        radius = level_radius(level, options.levels, options.sampling)
        return sample_level(
            stack, CLASSES.surfaces, hull, radius, options.sampling, rng, Unobserved()
        )

    shifts = SliceShifts(stack, no_evidence(len(stack.slices), 0.05), 0.2)
    return fit_field(samples_of, shifts, CLASSES, options, Unobserved(), start)


def on_contours(stack: UnitStack, fit: FieldFit) -> float:
    """Mean size of a surface's logit on its own contours, where it should be zero."""
    sizes = []
    for column, structure in enumerate(CLASSES.surfaces):
        points = torch.as_tensor(stack.showing([structure]).points_unit, dtype=torch.float32)
        with torch.no_grad():
            sizes.append(fit.surface_logits(fit.field(points))[:, column].abs().mean().item())
    return float(np.mean(sizes))


def test_weight_on_contours_brings_their_logits_to_zero(stack: UnitStack) -> None:
    light, middle, heavy = (
        on_contours(stack, fitted(stack, options_with(contour_weight=weight)))
        for weight in (1.0, 8.0, 64.0)
    )
    assert heavy < middle < light
    assert heavy < 0.7 * light


def test_weight_on_the_hinge_flattens_the_field(stack: UnitStack) -> None:
    free, capped = (
        fitted(stack, options_with(hinge_weight=weight, hinge_slope=5.0)).levels[-1].hinge.mean()
        for weight in (1e-6, 1.0)
    )
    assert capped < 0.2 * free


def test_without_a_hinge_none_is_computed(stack: UnitStack) -> None:
    fit = fitted(stack, options_with(hinge_weight=0.0))
    assert all((level.hinge == 0.0).all() for level in fit.levels)


def test_levels_report_falling_losses_and_the_mix(stack: UnitStack) -> None:
    first, second = fitted(stack, options_with()).levels
    assert (first.level, second.level) == (0, 1)
    assert first.bce.shape == first.hinge.shape == (60,)
    assert second.bce.mean() < first.bce.mean()
    assert second.samples == 2 * first.samples


def test_a_fit_goes_on_from_a_field_and_leaves_that_as_it_was(stack: UnitStack) -> None:
    options = options_with()
    first = fitted(stack, options)
    before = [p.detach().clone() for p in first.field.parameters()]
    second = fitted(stack, options, start=first.field)
    for now, then in zip(first.field.parameters(), before, strict=True):
        torch.testing.assert_close(now.detach(), then, rtol=0.0, atol=0.0)
    assert second.levels[0].bce[:5].mean() < first.levels[0].bce[:5].mean()
    assert on_contours(stack, second) < on_contours(stack, first)
