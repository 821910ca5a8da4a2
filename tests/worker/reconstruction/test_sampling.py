"""Samples say the truth about the shape that was sliced, and only where it was looked at."""

import numpy as np
import pytest

from schemas.options import SamplingOptions
from schemas.study import ContourStudy
from schemas.vocabulary import Structure
from worker.observer import Unobserved
from worker.reconstruction.hull import inflated_hull
from worker.reconstruction.normalisation import normalise
from worker.reconstruction.samples import NO_SLICE
from worker.reconstruction.sampling import level_radius, sample_level
from worker.reconstruction.stacking import build_stack

OPTIONS = SamplingOptions()
ENDO, EPI, RV = Structure.LV_ENDO, Structure.LV_EPI, Structure.RV_ENDO
CENTRE_MM = np.array([12.0, -30.0, 55.0])


@pytest.fixture
def sampled(concentric_spheres):
    """Unit frame and one level's samples of spheres of 25 and 35 mm, and of an unseen RV."""
    study = concentric_spheres(endo_mm=25.0, epi_mm=35.0)
    stack, frame = normalise(build_stack(study, study.frames[0]))
    hull = inflated_hull(stack.points_unit, OPTIONS.hull_inflation)
    rng = np.random.default_rng(7)
    radius = level_radius(2, 6, OPTIONS)
    return (
        frame,
        stack,
        sample_level(stack, (ENDO, EPI, RV), hull, radius, OPTIONS, rng, Unobserved()),
    )


def test_targets_are_the_occupancy_of_the_spheres(sampled) -> None:
    frame, _, samples = sampled
    radii = np.linalg.norm(frame.to_mm(samples.points_unit) - CENTRE_MM, axis=1)
    for column, radius_mm in ((0, 25.0), (1, 35.0)):
        target, known = samples.targets[:, column], samples.known[:, column]
        # A polygon of 90 points lies within 0.03 mm of its circle.
        clear = np.abs(radii - radius_mm) > 0.03
        np.testing.assert_array_equal(target[known & clear], radii[known & clear] < radius_mm)
        boundary = known & (target == 0.5)
        assert boundary.sum() > 1000
        assert np.abs(radii[boundary] - radius_mm).max() < 0.05


def test_a_structure_never_looked_at_is_unknown_within_the_hull(sampled) -> None:
    _, _, samples = sampled
    np.testing.assert_array_equal(samples.known[:, 2], samples.slice_index == NO_SLICE)
    assert not samples.targets[:, 2].any()


def test_samples_lie_on_the_slice_they_name(sampled) -> None:
    _, stack, samples = sampled
    for index, slice_ in enumerate(stack.slices):
        own = samples.points_unit[samples.slice_index == index]
        assert len(own) > 0
        np.testing.assert_allclose((own - slice_.origin) @ slice_.normal, 0.0, atol=1e-12)


def test_beyond_the_hull_all_is_outside(sampled) -> None:
    frame, _, samples = sampled
    beyond = samples.slice_index == NO_SLICE
    assert beyond.sum() == OPTIONS.hull_samples + OPTIONS.far_samples
    assert samples.known[beyond].all()
    assert not samples.targets[beyond].any()
    radii = np.linalg.norm(frame.to_mm(samples.points_unit[beyond]) - CENTRE_MM, axis=1)
    assert radii.min() > 35.0


def test_a_chord_of_an_open_outline_is_no_observed_boundary(concentric_spheres) -> None:
    document = concentric_spheres().model_dump(mode="json")
    for slice_ in document["frames"][0]["slices"]:
        for contour in slice_["contours"]:
            contour["closed"] = False
            contour["points"] = contour["points"][:45]  # half a circle
    study = ContourStudy.model_validate(document)
    stack, frame = normalise(build_stack(study, study.frames[0]))
    hull = inflated_hull(stack.points_unit, OPTIONS.hull_inflation)
    samples = sample_level(
        stack, (ENDO, EPI), hull, 0.05, OPTIONS, np.random.default_rng(0), Unobserved()
    )
    boundary = samples.known[:, 0] & (samples.targets[:, 0] == 0.5)
    radii = np.linalg.norm(frame.to_mm(samples.points_unit[boundary]) - CENTRE_MM, axis=1)
    assert np.abs(radii - 25.0).max() < 0.05


def test_radii_close_in_geometrically_between_the_options() -> None:
    radii = [level_radius(level, 6, OPTIONS) for level in range(6)]
    assert radii[0] == pytest.approx(OPTIONS.first_radius)
    assert radii[-1] == pytest.approx(OPTIONS.last_radius)
    np.testing.assert_allclose(np.diff(np.log(radii)), np.log(radii[1] / radii[0]))
    assert level_radius(0, 1, OPTIONS) == OPTIONS.last_radius


def test_same_generator_same_samples(concentric_spheres) -> None:
    study = concentric_spheres()
    stack, _ = normalise(build_stack(study, study.frames[0]))
    hull = inflated_hull(stack.points_unit, 1.1)
    a, b = (
        sample_level(stack, (ENDO,), hull, 0.1, OPTIONS, np.random.default_rng(3), Unobserved())
        for _ in range(2)
    )
    np.testing.assert_array_equal(a.points_unit, b.points_unit)
    np.testing.assert_array_equal(a.targets, b.targets)
