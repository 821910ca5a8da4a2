"""Laws of the job's states."""

from itertools import product

import pytest
from pydantic import ValidationError

from schemas.job import JobState, Progress

STATES = list(JobState)
TERMINAL = [s for s in STATES if s.is_terminal]


def reachable(start: JobState) -> set[JobState]:
    seen, rim = {start}, [start]
    while rim:
        here = rim.pop()
        new = [s for s in STATES if here.may_become(s) and s not in seen]
        seen.update(new)
        rim.extend(new)
    return seen


def test_the_terminal_states_are_three() -> None:
    assert set(TERMINAL) == {JobState.SUCCEEDED, JobState.FAILED, JobState.CANCELLED}


@pytest.mark.parametrize(("terminal", "other"), list(product(TERMINAL, STATES)))
def test_terminal_states_never_change(terminal: JobState, other: JobState) -> None:
    assert not terminal.may_become(other)


@pytest.mark.parametrize("state", STATES)
def test_no_state_becomes_itself(state: JobState) -> None:
    assert not state.may_become(state)


@pytest.mark.parametrize("state", [s for s in STATES if not s.is_terminal])
def test_every_live_state_can_end(state: JobState) -> None:
    assert reachable(state) & set(TERMINAL)


def test_every_state_is_reached_from_queued() -> None:
    assert reachable(JobState.QUEUED) == set(STATES)


def test_success_follows_work_alone() -> None:
    before = {s for s in STATES if s.may_become(JobState.SUCCEEDED)}
    assert before == {JobState.RUNNING, JobState.CANCELLING}


def test_a_cancel_is_not_taken_back() -> None:
    assert not JobState.CANCELLING.may_become(JobState.RUNNING)
    assert not JobState.CANCELLING.may_become(JobState.QUEUED)


def test_a_lost_worker_sends_the_job_back_to_the_queue() -> None:
    assert JobState.RUNNING.may_become(JobState.QUEUED)


@pytest.mark.parametrize("fraction", [-0.01, 1.01, float("nan"), float("inf")])
def test_progress_is_a_fraction(fraction: float) -> None:
    with pytest.raises(ValidationError):
        Progress(fraction=fraction)
