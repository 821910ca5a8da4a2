import threading
import time
from collections.abc import Callable
from datetime import UTC, datetime

import pytest
from redis import Redis

from jobs.claim import Refusal
from jobs.errors import IllegalTransition, StaleToken
from jobs.records import JobRecords
from schemas.job import JobPage, JobState, Progress, Stage
from schemas.messages import ANONYMOUS, JobRequest, Outcome
from schemas.problem import InternalError, ProblemType

MakeRequest = Callable[[], JobRequest]


def outcome(state: JobState, attempt: int = 1) -> Outcome:
    now = datetime.now(tz=UTC)
    return Outcome(state=state, started_at=now, finished_at=now, attempt=attempt)


def state(records: JobRecords, job_id: str) -> JobState:
    job = records.get(job_id)
    assert job is not None
    return job.state


def claimed(records: JobRecords, job_id: str, lease_s: float = 30.0) -> int:
    claim = records.claim(job_id, lease_s, max_attempts=3)
    assert claim.granted
    assert claim.token is not None
    return claim.token


@pytest.fixture
def job_id(records: JobRecords, request_: JobRequest) -> str:
    records.accepted(request_)
    return request_.job_id


def test_an_accepted_job_is_queued(records: JobRecords, request_: JobRequest) -> None:
    assert records.get(request_.job_id) is None
    records.accepted(request_)
    job = records.get(request_.job_id)
    assert job is not None
    assert (job.state, job.kind, job.created_at, job.attempt) == (
        JobState.QUEUED,
        request_.kind,
        request_.created_at,
        0,
    )
    token = claimed(records, request_.job_id)
    records.accepted(request_)
    assert records.renew(request_.job_id, token, 30.0), "accepting again changes nothing"


def test_a_job_runs_and_succeeds(records: JobRecords, job_id: str) -> None:
    claim = records.claim(job_id, 30.0, 3)
    assert claim.granted
    assert claim.attempt == 1
    assert claim.token is not None
    progress = Progress(fraction=0.5, stage=Stage.FITTING, frame="ED", level=2, loss=0.1)
    records.advanced(job_id, claim.token, progress)
    job = records.get(job_id)
    assert job is not None
    assert (job.state, job.progress, job.started_at) == (
        JobState.RUNNING,
        progress,
        claim.started_at,
    )
    assert records.renew(job_id, claim.token, 30.0)
    end = outcome(JobState.SUCCEEDED)
    records.finished(job_id, claim.token, end)
    records.finished(job_id, claim.token, end)
    job = records.get(job_id)
    assert job is not None
    assert (job.state, job.finished_at, job.progress.fraction, job.progress.stage) == (
        JobState.SUCCEEDED,
        end.finished_at,
        1.0,
        Stage.DONE,
    )
    assert records.claim(job_id, 30.0, 3).refusal is Refusal.ENDED


def test_of_many_claimers_one_is_granted(records: JobRecords, job_id: str) -> None:
    claims = []
    start = threading.Barrier(8)

    def claim() -> None:
        start.wait()
        claims.append(records.claim(job_id, 30.0, 3))

    threads = [threading.Thread(target=claim) for _ in range(8)]
    for thread in threads:
        thread.start()
    for thread in threads:
        thread.join()
    assert [c.refusal for c in claims].count(None) == 1
    assert [c.refusal for c in claims].count(Refusal.HELD) == 7
    assert len([c for c in claims if c.token is not None]) == 1


def test_a_stale_token_changes_nothing(records: JobRecords, job_id: str) -> None:
    slow = claimed(records, job_id, lease_s=0.05)
    time.sleep(0.1)
    fast = claimed(records, job_id)
    assert fast > slow
    assert not records.renew(job_id, slow, 30.0)
    with pytest.raises(StaleToken):
        records.advanced(job_id, slow, Progress(fraction=0.9))
    with pytest.raises(StaleToken):
        records.finished(job_id, slow, outcome(JobState.FAILED))
    with pytest.raises(StaleToken):
        records.released(job_id, slow)
    job = records.get(job_id)
    assert job is not None
    assert (job.state, job.progress.fraction, job.attempt) == (JobState.RUNNING, 0.0, 2)
    records.finished(job_id, fast, outcome(JobState.SUCCEEDED, 2))
    with pytest.raises(StaleToken):
        records.finished(job_id, slow, outcome(JobState.SUCCEEDED))


def test_an_expired_lease_that_nobody_took_is_still_good(records: JobRecords, job_id: str) -> None:
    token = claimed(records, job_id, lease_s=0.02)
    time.sleep(0.05)
    assert records.renew(job_id, token, 30.0)
    assert records.claim(job_id, 30.0, 3).refusal is Refusal.HELD


def test_fences_grow_even_when_redis_lost_everything(
    records: JobRecords, redis: Redis, request_: JobRequest
) -> None:
    records.accepted(request_)
    before = claimed(records, request_.job_id)
    redis.flushall()
    assert not records.renew(request_.job_id, before, 30.0)
    assert records.restore(request_, None)
    after = claimed(records, request_.job_id)
    assert after > before
    with pytest.raises(StaleToken):
        records.finished(request_.job_id, before, outcome(JobState.SUCCEEDED))


def test_lost_attempts_are_counted_and_then_end_the_job(records: JobRecords, job_id: str) -> None:
    for attempt in (1, 2, 3):
        claim = records.claim(job_id, 0.01, max_attempts=3)
        assert (claim.granted, claim.attempt) == (True, attempt)
        time.sleep(0.03)
    claim = records.claim(job_id, 30.0, max_attempts=3)
    assert claim.refusal is Refusal.EXHAUSTED
    assert claim.attempt == 3
    assert claim.token is not None
    problem = InternalError(ProblemType.WORKER_LOST, "three workers were lost").problem()
    end = outcome(JobState.FAILED, 3).model_copy(update={"error": problem})
    records.finished(job_id, claim.token, end)
    job = records.get(job_id)
    assert job is not None
    assert job.error == problem
    assert records.claim(job_id, 30.0, 3).refusal is Refusal.ENDED


def test_a_job_handed_back_is_queued_and_loses_no_attempt(records: JobRecords, job_id: str) -> None:
    for _ in range(5):
        token = claimed(records, job_id)
        records.released(job_id, token)
        assert state(records, job_id) is JobState.QUEUED
        assert not records.renew(job_id, token, 30.0)
    assert records.claim(job_id, 30.0, 3).attempt == 1


def test_a_claim_says_how_long_nobody_had_held_the_job(records: JobRecords, job_id: str) -> None:
    time.sleep(0.3)
    first = records.claim(job_id, 30.0, 3)
    assert 0.3 <= first.waited_s < 30.0
    assert first.token is not None
    time.sleep(0.6)
    records.released(job_id, first.token)
    assert records.claim(job_id, 30.0, 3).waited_s < 0.6, "from when it was handed back"
    assert records.claim(job_id, 30.0, 3).waited_s == 0.0, "it is held"


def test_the_trace_of_a_job_is_known(records: JobRecords, request_: JobRequest) -> None:
    assert records.traceparent(request_.job_id) is None
    traced = request_.model_copy(update={"traceparent": f"00-{'a' * 32}-{'b' * 16}-01"})
    records.accepted(traced)
    assert records.traceparent(request_.job_id) == traced.traceparent


def test_claiming_what_is_unknown(records: JobRecords) -> None:
    claim = records.claim("0" * 32, 30.0, 3)
    assert (claim.token, claim.refusal) == (None, Refusal.UNKNOWN)
    assert records.request_cancel("0" * 32) is None
    assert not records.is_cancel_requested("0" * 32)
    assert not records.renew("0" * 32, 1, 30.0)


def test_a_queued_job_is_cancelled_at_once(records: JobRecords, job_id: str) -> None:
    assert records.request_cancel(job_id) is JobState.CANCELLED
    assert records.request_cancel(job_id) is JobState.CANCELLED
    assert records.claim(job_id, 30.0, 3).refusal is Refusal.ENDED
    job = records.get(job_id)
    assert job is not None
    assert job.finished_at is not None


def test_a_running_job_is_cancelled_by_its_worker(records: JobRecords, job_id: str) -> None:
    token = claimed(records, job_id)
    assert not records.is_cancel_requested(job_id)
    assert records.request_cancel(job_id) is JobState.CANCELLING
    assert records.request_cancel(job_id) is JobState.CANCELLING
    assert records.is_cancel_requested(job_id)
    assert records.renew(job_id, token, 30.0), "it may still be cleaning up"
    records.finished(job_id, token, outcome(JobState.CANCELLED))
    assert records.request_cancel(job_id) is JobState.CANCELLED


def test_the_last_cancellation_says_whether_frames_are_kept(
    records: JobRecords, job_id: str
) -> None:
    claimed(records, job_id)
    assert not records.keeps_frames(job_id)
    records.request_cancel(job_id, keeps_frames=True)
    records.request_cancel(job_id, keeps_frames=None)
    assert records.keeps_frames(job_id)
    records.request_cancel(job_id)
    assert not records.keeps_frames(job_id)


def test_a_job_that_ends_before_it_sees_the_cancellation(records: JobRecords, job_id: str) -> None:
    token = claimed(records, job_id)
    records.request_cancel(job_id)
    records.finished(job_id, token, outcome(JobState.SUCCEEDED))
    assert records.request_cancel(job_id) is JobState.SUCCEEDED


def test_cancelling_a_job_whose_worker_is_lost(records: JobRecords, job_id: str) -> None:
    token = claimed(records, job_id, lease_s=0.02)
    time.sleep(0.05)
    assert records.request_cancel(job_id) is JobState.CANCELLED
    assert not records.renew(job_id, token, 30.0)


def test_a_worker_lost_while_cancelling(records: JobRecords, job_id: str) -> None:
    claimed(records, job_id, lease_s=0.5)
    assert records.request_cancel(job_id) is JobState.CANCELLING
    time.sleep(0.6)
    claim = records.claim(job_id, 30.0, max_attempts=1)
    assert claim.granted
    assert state(records, job_id) is JobState.CANCELLING


def test_the_lifecycle_is_obeyed(records: JobRecords, job_id: str) -> None:
    token = claimed(records, job_id)
    with pytest.raises(IllegalTransition):
        records.finished(job_id, token, outcome(JobState.CANCELLED))
    assert state(records, job_id) is JobState.RUNNING


def test_a_lost_job_is_reclaimed_by_one(records: JobRecords, job_id: str) -> None:
    assert not records.reclaimed(job_id, 0.4)
    time.sleep(0.5)
    assert records.reclaimed(job_id, 0.4)
    assert not records.reclaimed(job_id, 0.4)
    token = claimed(records, job_id, lease_s=0.05)
    time.sleep(0.6)
    assert records.reclaimed(job_id, 0.4)
    assert state(records, job_id) is JobState.QUEUED
    assert not records.renew(job_id, token, 30.0)


def test_a_held_or_cancelling_or_ended_job_is_not_reclaimed(
    records: JobRecords, job_id: str
) -> None:
    token = claimed(records, job_id, lease_s=0.5)
    assert not records.reclaimed(job_id, 0.0)
    records.request_cancel(job_id)
    time.sleep(0.6)
    assert not records.reclaimed(job_id, 0.0)
    records.finished(job_id, token, outcome(JobState.CANCELLED))
    assert not records.reclaimed(job_id, 0.0)


def test_the_folder_overrules_the_record(records: JobRecords, request_: JobRequest) -> None:
    assert records.restore(request_, None)
    assert not records.restore(request_, None)
    token = claimed(records, request_.job_id)
    assert not records.restore(request_, outcome(JobState.SUCCEEDED))
    assert state(records, request_.job_id) is JobState.SUCCEEDED
    assert not records.renew(request_.job_id, token, 30.0)
    assert records.counts()[JobState.SUCCEEDED] == 1
    assert records.counts()[JobState.RUNNING] == 0


def test_forgetting_leaves_no_trace(records: JobRecords, redis: Redis, job_id: str) -> None:
    claimed(records, job_id)
    records.forget(job_id)
    records.forget(job_id)
    assert records.get(job_id) is None
    (tallies,) = redis.keys("*")
    assert job_id not in str(redis.hgetall(tallies))


def pages(records: JobRecords, state: JobState | None, limit: int) -> list[JobPage]:
    found = [records.page(ANONYMOUS, state, limit)]
    while found[-1].next_cursor:
        found.append(records.page(ANONYMOUS, state, limit, found[-1].next_cursor))
    return found


@pytest.mark.parametrize("limit", [1, 3, 4, 7, 100])
def test_pages_are_complete_and_newest_first(
    records: JobRecords, make_request: MakeRequest, limit: int
) -> None:
    requests = [make_request() for _ in range(7)]
    for request in requests:
        records.accepted(request)
    other = make_request().model_copy(update={"owner": "somebody"})
    records.accepted(other)
    for request in requests[::2]:
        records.request_cancel(request.job_id)
    seen = [job.id for page in pages(records, None, limit) for job in page.jobs]
    assert seen == [r.job_id for r in reversed(requests)]
    cancelled = pages(records, JobState.CANCELLED, limit)
    assert [job.id for page in cancelled for job in page.jobs] == [
        r.job_id for r in reversed(requests[::2])
    ]
    assert all(len(page.jobs) == limit for page in cancelled[:-1])
    assert [j.id for j in records.page("somebody").jobs] == [other.job_id]
    assert records.ids() == [*(r.job_id for r in requests), other.job_id]


def test_pages_are_stable_while_jobs_come_and_go(
    records: JobRecords, make_request: MakeRequest
) -> None:
    requests = [make_request() for _ in range(6)]
    for request in requests:
        records.accepted(request)
    first = records.page(ANONYMOUS, limit=3)
    records.accepted(make_request())
    records.forget(requests[3].job_id)  # the very job the cursor names
    records.forget(requests[1].job_id)
    second = records.page(ANONYMOUS, limit=3, cursor=first.next_cursor)
    assert [job.id for job in second.jobs] == [requests[2].job_id, requests[0].job_id]
    assert second.next_cursor is None


def test_a_job_is_held_while_its_lease_lives(records: JobRecords, job_id: str) -> None:
    assert not records.is_any_held()
    token = claimed(records, job_id)
    assert records.is_any_held()
    records.renew(job_id, token, 0.0)
    assert not records.is_any_held()
