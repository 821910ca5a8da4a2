"""Noise slows the field and lightens its contours, and nothing else changes."""

import pytest

from schemas.options import Options, Preset
from worker.reconstruction.tempering import tempered

DEFAULT = Options()
RADIUS = DEFAULT.sampling.last_radius


def test_exact_outlines_are_followed_as_the_options_say() -> None:
    assert tempered(DEFAULT, 0.0) == DEFAULT


def test_noise_of_the_last_radius_halves_rate_and_weight() -> None:
    half = tempered(DEFAULT, RADIUS)
    assert half.optimizer.learning_rate == pytest.approx(0.5 * DEFAULT.optimizer.learning_rate)
    assert half.loss.contour_weight == pytest.approx(0.5 * DEFAULT.loss.contour_weight)


def test_more_noise_never_makes_it_bolder_and_it_never_stands_still() -> None:
    steps = [tempered(DEFAULT, k * RADIUS) for k in (0.0, 0.5, 1.0, 3.0, 10.0, 1000.0)]
    rates = [one.optimizer.learning_rate for one in steps]
    weights = [one.loss.contour_weight for one in steps]
    assert rates == sorted(rates, reverse=True)
    assert weights == sorted(weights, reverse=True)
    assert rates[-1] == pytest.approx(0.1 * DEFAULT.optimizer.learning_rate)
    assert weights[-1] == 1.0


def test_a_light_contour_stays_as_light_as_it_was_asked_to_be() -> None:
    light = Options.model_validate({"loss": {"contour_weight": 0.25}})
    assert tempered(light, 100.0 * RADIUS).loss.contour_weight == 0.25


def test_nothing_else_changes() -> None:
    before, after = Options(preset=Preset.FAST), tempered(Options(preset=Preset.FAST), RADIUS)
    restored = after.model_copy(update={"optimizer": before.optimizer, "loss": before.loss})
    assert restored == before
    assert after.optimizer.samples_per_step == before.optimizer.samples_per_step
    assert after.loss.hinge_slope == before.loss.hinge_slope
