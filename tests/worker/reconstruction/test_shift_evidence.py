"""What evidence says in its closed forms: precisions, deviations, and none at all."""

from dataclasses import replace

import numpy as np
import pytest

from worker.reconstruction.shift_evidence import (
    TURN_PRIOR,
    ShiftEvidence,
    no_evidence,
    prior_precision,
)


def test_a_prior_is_the_inverse_of_squared_deviations() -> None:
    covariance = np.linalg.inv(prior_precision(0.05, True))
    np.testing.assert_allclose(covariance, np.diag([0.05**2, 0.05**2, TURN_PRIOR**2]))


def test_without_turning_a_turn_is_held_at_nothing() -> None:
    assert np.linalg.inv(prior_precision(0.05, False))[2, 2] ** 0.5 < np.radians(0.01)


def test_no_evidence_moves_nothing_and_knows_no_deviation() -> None:
    evidence = no_evidence(4, 0.05)
    assert not evidence.displaced
    assert not evidence.motion.any()
    assert not evidence.crossings.any()
    assert np.isnan(evidence.deviations()).all()
    np.testing.assert_allclose(np.linalg.inv(evidence.precision[3])[:2, :2], 0.0025 * np.eye(2))


@pytest.mark.parametrize("degrees", [0.0, 25.0, 90.0])
def test_a_deviation_is_that_of_the_least_certain_direction(degrees: float) -> None:
    c, s = np.cos(np.radians(degrees)), np.sin(np.radians(degrees))
    turn = np.array([[c, -s, 0.0], [s, c, 0.0], [0.0, 0.0, 1.0]])
    covariance = turn @ np.diag([0.01**2, 0.03**2, 9.0]) @ turn.T
    evidence = ShiftEvidence(
        motion=np.zeros((2, 3)),
        precision=np.tile(np.linalg.inv(covariance), (2, 1, 1)),
        crossings=np.array([3, 0]),
        settled=np.zeros(2, dtype=bool),
        displaced=True,
    )
    np.testing.assert_allclose(evidence.deviations(), [0.03, np.nan])


def test_a_turn_that_is_not_known_leaves_a_shift_that_hangs_on_it_uncertain() -> None:
    """Deviations are marginal: whatever the turn is."""
    precision = np.array([[4.0, 0.0, 1.9], [0.0, 4.0, 0.0], [1.9, 0.0, 1.0]])
    evidence = replace(
        no_evidence(1, 1.0), precision=precision[None], crossings=np.array([4]), displaced=True
    )
    np.testing.assert_allclose(evidence.deviations(), (4.0 - 1.9**2) ** -0.5)
