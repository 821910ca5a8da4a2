"""Displacement and noise that were put in are told apart again."""

from dataclasses import replace

import numpy as np
import pytest

from worker.reconstruction.shift_variance import (
    ShiftVariance,
    SliceOffsets,
    shift_variance,
)

LEAST, MOST = 0.01, 12.0


def crossed(
    displacement: float, noise: float, *, slices: int = 200, each: int = 8, seed: int = 0
) -> list[SliceOffsets]:
    """Slices each crossed in `each` directions, with weights between a quarter and one."""
    generator = np.random.default_rng(seed)
    found = []
    for _ in range(slices):
        angles = generator.uniform(0.0, 2.0 * np.pi, each)
        normals = np.column_stack([np.cos(angles), np.sin(angles)])
        weights = generator.uniform(0.25, 1.0, each)
        errors = noise * generator.standard_normal(each) / np.sqrt(weights)
        shift = displacement * generator.standard_normal(2)
        found.append(SliceOffsets(normals, normals @ shift + errors, weights))
    return found


@pytest.mark.parametrize(("displacement", "noise"), [(3.0, 0.2), (0.5, 0.5), (2.0, 1.0)])
def test_both_are_found(displacement: float, noise: float) -> None:
    found = shift_variance(crossed(displacement, noise), LEAST, MOST)
    assert found.displacement == pytest.approx(displacement, rel=0.15)
    assert found.noise == pytest.approx(noise, rel=0.1)
    assert found.evidence > 10.0


@pytest.mark.parametrize("seed", range(20))
def test_an_unsteady_hand_alone_is_no_evidence_of_displacement(seed: int) -> None:
    """Twice the evidence is a mixture of nothing and chi squared: 3 nats come once in 140 times."""
    found = shift_variance(crossed(0.0, 0.7, slices=12, seed=seed), LEAST, MOST)
    assert found.evidence < 3.0
    assert found.noise == pytest.approx(0.7, rel=0.25)
    assert found.displacement < 0.4


def test_crossings_of_one_slice_are_one_shift() -> None:
    """The same offsets, once in common to each slice and once shuffled among all slices."""
    slices = [replace(one, weights=np.ones(8)) for one in crossed(1.0, 0.1)]
    everything = SliceOffsets(
        *(
            np.concatenate([getattr(one, name) for one in slices])
            for name in ("normals", "offsets", "weights")
        )
    )
    order = np.random.default_rng(1).permutation(len(everything.offsets))
    parts = np.array_split(order, len(slices))
    shuffled = [
        SliceOffsets(everything.normals[p], everything.offsets[p], everything.weights[p])
        for p in parts
    ]
    together, apart = (shift_variance(one, LEAST, MOST) for one in (slices, shuffled))
    assert together.evidence > 100.0 > 3.0 > apart.evidence
    assert apart.noise > 5.0 * together.noise


def test_lengths_scale() -> None:
    slices = crossed(1.0, 0.4)
    scaled = [SliceOffsets(s.normals, 7.0 * s.offsets, s.weights) for s in slices]
    one, seven = shift_variance(slices, LEAST, MOST), shift_variance(scaled, 7 * LEAST, 7 * MOST)
    assert seven.noise == pytest.approx(7.0 * one.noise)
    assert seven.displacement == pytest.approx(7.0 * one.displacement)
    assert seven.evidence == pytest.approx(one.evidence)


def test_no_steadier_outlines_than_told_are_believed_in() -> None:
    """A tenth of a millimetre of displacement is none where outlines are not known to a quarter."""
    slices = crossed(0.1, 0.01, slices=12)
    assert shift_variance(slices, LEAST, MOST).evidence > 10.0
    doubting = shift_variance(slices, LEAST, MOST, least_noise=0.25)
    assert doubting.evidence < 1.0
    assert doubting.noise == pytest.approx(0.01, rel=0.25)


def test_where_nothing_crosses_nothing_is_known() -> None:
    nothing = SliceOffsets(np.empty((0, 2)), np.empty(0), np.empty(0))
    assert shift_variance([nothing, nothing], LEAST, MOST) == ShiftVariance(0.0, 0.0, 0.0)


def test_a_slice_that_nothing_crosses_changes_nothing() -> None:
    slices = crossed(1.0, 0.4, slices=12)
    nothing = SliceOffsets(np.empty((0, 2)), np.empty(0), np.empty(0))
    assert shift_variance(slices, LEAST, MOST) == shift_variance([*slices, nothing], LEAST, MOST)
