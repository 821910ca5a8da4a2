"""What was found to need nothing more is not looked at again, until something says otherwise."""

from collections.abc import Callable
from datetime import UTC, datetime

import pytest
from redis import Redis

from jobs.queue import JobQueue
from jobs.reconcile import Reconciled, reconcile
from jobs.records import JobRecords
from jobs.settled import Settled
from jobs.store import JobStore
from jobs.submission import submit
from schemas.job import JobState
from schemas.messages import JobRequest, Outcome

Round = Callable[[], Reconciled]


@pytest.fixture
def settled() -> Settled:
    return Settled()


@pytest.fixture
def round_(store: JobStore, records: JobRecords, queue: JobQueue, settled: Settled) -> Round:
    return lambda: reconcile(store, records, queue, 3600.0, settled)


@pytest.fixture
def job_id(
    store: JobStore,
    records: JobRecords,
    queue: JobQueue,
    redis: Redis,
    request_: JobRequest,
    round_: Round,
) -> str:
    """A job that has ended, and that two rounds have seen."""
    job = submit(store, records, queue, request_, {})
    redis.lpop("neuralmri")
    token = records.claim(job.id, 60.0, 3).token
    assert token is not None
    end = Outcome(
        state=JobState.SUCCEEDED, started_at=None, finished_at=datetime.now(tz=UTC), attempt=1
    )
    records.finished(job.id, token, store.folder(job.id).write_outcome(end))
    assert round_() == round_() == Reconciled()
    return job.id


def test_a_settled_job_is_not_looked_at_again(
    settled: Settled, store: JobStore, records: JobRecords, job_id: str
) -> None:
    assert settled.left(store.ids(), records) == []
    assert Settled().left(store.ids(), records) == [job_id]


def test_a_redis_that_forgot_is_told_again(round_: Round, redis: Redis, job_id: str) -> None:
    redis.flushall()
    assert round_().ended == (job_id,)
    assert round_() == round_() == Reconciled()


def test_a_redis_that_went_back_is_told_again(
    round_: Round, redis: Redis, records: JobRecords, job_id: str
) -> None:
    redis.hset(f"neuralmri:job:{job_id}", "state", "running")
    assert round_().ended == (job_id,)
    job = records.get(job_id)
    assert job is not None
    assert job.state is JobState.SUCCEEDED


def test_a_job_that_was_erased_is_forgotten(
    round_: Round, store: JobStore, records: JobRecords, job_id: str
) -> None:
    store.folder(job_id).erase()
    assert round_().forgotten == (job_id,)
    assert records.get(job_id) is None


def test_a_job_that_has_not_ended_is_looked_at_every_time(
    settled: Settled,
    round_: Round,
    store: JobStore,
    records: JobRecords,
    queue: JobQueue,
    request_: JobRequest,
) -> None:
    waiting = submit(store, records, queue, request_, {})
    round_()
    assert settled.left(store.ids(), records) == [waiting.id]
