from dataclasses import replace
from datetime import UTC, datetime
from itertools import product

import pytest
from hypothesis import settings
from hypothesis import strategies as st
from hypothesis.stateful import RuleBasedStateMachine, invariant, rule

from jobs import transitions
from jobs.errors import IllegalTransition, StaleToken
from jobs.record import Record
from schemas.job import JobKind, JobState
from schemas.messages import Outcome

NOW_US = 1_700_000_000_000_000


def record(state: JobState, *, held: bool, token: int = 7) -> Record:
    return Record(
        job_id="0" * 32,
        owner="anonymous",
        kind=JobKind.CONTOURS,
        state=state,
        created_at=datetime.now(tz=UTC),
        attempt=1,
        token=token,
        free_from_us=NOW_US + (10 if held else -10),
        lease_us=20,
    )


@pytest.mark.parametrize(("before", "after"), list(product(JobState, JobState)))
def test_a_record_changes_state_as_the_lifecycle_says(before: JobState, after: JobState) -> None:
    start = record(before, held=True)
    if after is before or before.may_become(after):
        assert start.to(after).state is after
    else:
        with pytest.raises(IllegalTransition):
            start.to(after)


@pytest.mark.parametrize(("state", "held"), list(product(JobState, (True, False))))
def test_cancelling_ends_in_a_state_that_cancelling_again_keeps(
    state: JobState, held: bool
) -> None:
    once = transitions.cancel_requested(record(state, held=held), NOW_US)
    assert transitions.cancel_requested(once, NOW_US) == once
    if state.is_terminal:
        assert once.state is state
    else:
        assert once.state is (JobState.CANCELLING if held else JobState.CANCELLED)


@pytest.mark.parametrize("state", [s for s in JobState if s.is_terminal])
def test_terminal_states_never_change_by_a_worker(state: JobState) -> None:
    start = record(state, held=False)
    for other in JobState:
        end = Outcome(state=other, started_at=None, finished_at=datetime.now(tz=UTC), attempt=9)
        if other is state:
            assert transitions.finished(start, 7, end) == start
        else:
            with pytest.raises(Exception, match="taken over"):
                transitions.finished(start, 7, end)


@pytest.mark.parametrize(("state", "held"), list(product(JobState, (True, False))))
def test_a_record_survives_its_spelling(state: JobState, held: bool) -> None:
    start = record(state, held=held)
    assert Record.of_fields(start.job_id, start.fields()) == start


class Lives(RuleBasedStateMachine):
    """A job under workers that die, pause and race, callers that cancel, and a reconciler."""

    MAX_ATTEMPTS = 3
    LEASE_S = 1.0

    def __init__(self) -> None:
        super().__init__()
        self.now_us = NOW_US
        self.record = replace(record(JobState.QUEUED, held=False, token=0), attempt=0)
        self.tokens: list[int] = []

    def become(self, after: Record) -> None:
        before = self.record
        assert after.state is before.state or _reachable(before.state, after.state)
        assert after.token >= before.token
        self.record = after

    @rule(seconds=st.sampled_from([0.1, 0.6, 1.1, 5.0]))
    def time_passes(self, seconds: float) -> None:
        self.now_us += int(seconds * 1e6)

    @rule()
    def claim(self) -> None:
        why = transitions.refusal(self.record, self.now_us, self.MAX_ATTEMPTS)
        if why is None:
            held = transitions.leased(self.record, self.now_us, self.LEASE_S)
            self.become(transitions.started(held, self.now_us))
            assert self.record.token not in self.tokens
            self.tokens.append(self.record.token)

    @rule(data=st.data(), state=st.sampled_from([s for s in JobState if s.is_terminal]))
    def some_worker_finishes(self, data: st.DataObject, state: JobState) -> None:
        if not self.tokens:
            return
        token = data.draw(st.sampled_from(self.tokens))
        end = Outcome(state=state, started_at=None, finished_at=datetime.now(tz=UTC), attempt=1)
        newest = token == self.record.token and not self.record.state.is_terminal
        try:
            after = transitions.finished(self.record, token, end)
        except StaleToken:
            assert not newest
        except IllegalTransition:
            assert not self.record.state.may_become(state)
        else:
            assert newest or after == self.record
            self.become(after)

    @rule(data=st.data(), release=st.booleans())
    def some_worker_renews_or_releases(self, data: st.DataObject, release: bool) -> None:
        if not self.tokens:
            return
        token = data.draw(st.sampled_from(self.tokens))
        newest = token == self.record.token and not self.record.state.is_terminal
        try:
            if release:
                self.become(transitions.released(self.record, token, self.now_us))
            else:
                self.become(transitions.renewed(self.record, token, self.now_us, self.LEASE_S))
        except StaleToken:
            assert not newest
        else:
            assert newest

    @rule()
    def a_caller_cancels(self) -> None:
        self.become(transitions.cancel_requested(self.record, self.now_us))

    @rule()
    def the_reconciler_looks(self) -> None:
        if transitions.is_lost(self.record, self.now_us, 0.5):
            self.become(transitions.reclaimed(self.record, self.now_us))

    @invariant()
    def attempts_are_bounded(self) -> None:
        assert 0 <= self.record.attempt <= self.MAX_ATTEMPTS


def _reachable(before: JobState, after: JobState) -> bool:
    """In one step of the lifecycle, or by way of cancelling."""
    through = before.may_become(JobState.CANCELLING) and JobState.CANCELLING.may_become(after)
    return before.may_become(after) or through


TestLives = Lives.TestCase
TestLives.settings = settings(max_examples=100, stateful_step_count=30, deadline=None)
