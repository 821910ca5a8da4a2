"""Spans of attempts that end well, badly, or not at all."""

from dataclasses import dataclass, field, replace
from datetime import UTC, datetime

import pytest

from jobs import spans
from jobs.claim import Claim
from jobs.spans import Span
from jobs.trace_context import TraceContext
from schemas.job import JobState, Progress, Stage
from schemas.messages import Outcome
from schemas.problem import InputError, InternalError, Problem, ProblemType
from worker.attempt_spans import AttemptSpans, SpannedObserver
from worker.observer import Unobserved

REQUEST = replace(TraceContext.begun(), is_sampled=True)
CLAIM = Claim(token=1, attempt=2, started_at=None, waited_s=5.0)


@dataclass
class Kept:
    """A recorder that keeps what it is given."""

    spans: list[Span] = field(default_factory=list)

    def record(self, span: Span) -> None:
        self.spans.append(span)

    def stop(self) -> None:
        """Nothing waits."""


@pytest.fixture
def kept(monkeypatch: pytest.MonkeyPatch) -> dict[str, Span]:
    recorder = Kept()
    monkeypatch.setattr(spans, "_recorder", recorder)
    return _ByName(recorder)


class _ByName(dict[str, Span]):
    def __init__(self, recorder: Kept) -> None:
        super().__init__()
        self.recorder = recorder

    def __missing__(self, name: str) -> Span:
        (found,) = [span for span in self.recorder.spans if span.name == name]
        return found


def outcome(state: JobState, error: Problem | None = None) -> Outcome:
    return Outcome(
        state=state, started_at=None, finished_at=datetime.now(UTC), attempt=2, error=error
    )


def test_wait_attempt_and_stages_hang_together(kept: dict[str, Span]) -> None:
    with AttemptSpans("019c", CLAIM, REQUEST) as attempt:
        observer = SpannedObserver(Unobserved(), attempt)
        for stage in (Stage.READING, Stage.FITTING, Stage.FITTING, Stage.DONE):
            observer.advanced(Progress(stage=stage))
        attempt.outcome = outcome(JobState.SUCCEEDED)
    wait, whole = kept["job wait"], kept["job attempt"]
    reading, fitting = kept["job reading"], kept["job fitting"]
    assert wait.parent_id == whole.parent_id == REQUEST.span_id
    assert reading.parent_id == fitting.parent_id == whole.place.span_id
    assert wait.ended_s - wait.begun_s == pytest.approx(5.0)
    assert wait.ended_s == whole.begun_s <= reading.begun_s <= reading.ended_s <= fitting.begun_s
    assert fitting.ended_s <= whole.ended_s
    every = (wait, whole, reading, fitting)
    assert {span.place.trace_id for span in every} == {REQUEST.trace_id}
    assert len({span.place.span_id for span in every}) == 4
    assert whole.attributes == {
        "neuralmri.job.id": "019c",
        "neuralmri.job.attempt": 2,
        "neuralmri.job.outcome": "succeeded",
    }


@pytest.mark.parametrize(
    ("error", "is_failed"),
    [
        (InputError(ProblemType.INVALID_REQUEST, "mend it"), False),
        (InternalError(ProblemType.INTERNAL, "our fault"), True),
    ],
)
def test_only_our_own_faults_are_failures(
    kept: dict[str, Span], error: InputError | InternalError, is_failed: bool
) -> None:
    problem = error.problem(instance="/v1/jobs/019c")
    with AttemptSpans("019c", CLAIM, REQUEST) as attempt:
        attempt.outcome = outcome(JobState.FAILED, problem)
    whole = kept["job attempt"]
    assert whole.failed is is_failed
    assert whole.attributes["error.type"] == problem.type
    assert all(problem.detail != value for value in whole.attributes.values())


def test_an_attempt_that_is_handed_back_ends_its_stage_and_not_the_job(
    kept: dict[str, Span],
) -> None:
    with AttemptSpans("019c", CLAIM, REQUEST) as attempt:
        SpannedObserver(Unobserved(), attempt).advanced(Progress(stage=Stage.FITTING))
    assert kept["job fitting"].ended_s <= kept["job attempt"].ended_s
    assert kept["job attempt"].attributes["neuralmri.job.outcome"] == "unfinished"
    assert not kept["job attempt"].failed


def test_a_job_of_no_known_trace_begins_one(kept: dict[str, Span]) -> None:
    with AttemptSpans("019c", CLAIM, None):
        pass
    whole, wait = kept["job attempt"], kept["job wait"]
    assert whole.parent_id is None
    assert whole.place.is_sampled
    assert wait.place.trace_id == whole.place.trace_id
