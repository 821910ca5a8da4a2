import threading
import time
from collections.abc import Callable
from datetime import UTC, datetime

import pytest
from redis import Redis

from jobs.ending import cancel, erase
from jobs.queue import JobQueue
from jobs.reconcile import Reconciled, reconcile
from jobs.records import JobRecords
from jobs.settled import Settled
from jobs.store import JobStore
from jobs.store_errors import StoreUnavailable
from jobs.submission import submit
from schemas.job import Job, JobState
from schemas.messages import JobRequest, Outcome
from tests.stores import remains

LONG_S = 3600.0


def outcome(state: JobState) -> Outcome:
    now = datetime.now(tz=UTC)
    return Outcome(state=state, started_at=now, finished_at=now, attempt=1)


@pytest.fixture
def store(any_store: JobStore) -> JobStore:
    return any_store


@pytest.fixture
def job(store: JobStore, records: JobRecords, queue: JobQueue, request_: JobRequest) -> Job:
    return submit(store, records, queue, request_, {})


def state(records: JobRecords, job: Job) -> JobState:
    found = records.get(job.id)
    assert found is not None
    return found.state


def claimed(records: JobRecords, redis: Redis, job: Job, lease_s: float = 60.0) -> int:
    """A worker's first two steps: fetch the message, claim the job."""
    redis.lpop("neuralmri")
    token = records.claim(job.id, lease_s, 3).token
    assert token is not None
    return token


def test_nothing_is_done_where_all_is_well(
    store: JobStore, records: JobRecords, queue: JobQueue, redis: Redis, job: Job
) -> None:
    assert reconcile(store, records, queue, 0.0) == Reconciled()
    token = claimed(records, redis, job)
    assert reconcile(store, records, queue, 0.0) == Reconciled()
    records.finished(job.id, token, store.folder(job.id).write_outcome(outcome(JobState.SUCCEEDED)))
    assert reconcile(store, records, queue, 0.0) == Reconciled()


def test_the_loss_of_redis_loses_no_job(
    store: JobStore,
    records: JobRecords,
    queue: JobQueue,
    redis: Redis,
    make_request: Callable[[], JobRequest],
) -> None:
    jobs = [submit(store, records, queue, make_request(), {}) for _ in range(4)]
    before = records.page("anonymous")
    token = claimed(records, redis, jobs[0])
    end = store.folder(jobs[0].id).write_outcome(outcome(JobState.SUCCEEDED))
    records.finished(jobs[0].id, token, end)
    redis.flushall()
    mended = reconcile(store, records, queue, LONG_S)
    assert mended.enqueued == mended.restored == tuple(job.id for job in jobs[1:])
    assert mended.ended == (jobs[0].id,)
    assert queue.waiting() == {job.id for job in jobs[1:]}
    after = records.page("anonymous")
    assert [job.id for job in after.jobs] == [job.id for job in before.jobs]
    assert after.jobs[:3] == before.jobs[:3]
    assert state(records, jobs[0]) is JobState.SUCCEEDED
    assert not reconcile(store, records, queue, LONG_S).is_something


def test_a_lost_message_is_sent_again_once(
    store: JobStore, records: JobRecords, queue: JobQueue, redis: Redis, job: Job
) -> None:
    redis.delete("neuralmri")
    assert not reconcile(store, records, queue, LONG_S).is_something
    time.sleep(0.05)
    assert reconcile(store, records, queue, 0.02).enqueued == (job.id,)
    time.sleep(0.05)
    assert not reconcile(store, records, queue, 0.02).is_something, "it waits in the queue"
    assert queue.depth() == 1


def test_a_job_whose_worker_died_is_sent_again(
    store: JobStore, records: JobRecords, queue: JobQueue, redis: Redis, job: Job
) -> None:
    claimed(records, redis, job, lease_s=3.0)
    assert not reconcile(store, records, queue, 0.0).is_something
    time.sleep(3.1)
    assert reconcile(store, records, queue, 0.0).enqueued == (job.id,)
    assert state(records, job) is JobState.QUEUED


def test_an_end_that_redis_did_not_hear_of(
    store: JobStore, records: JobRecords, queue: JobQueue, redis: Redis, job: Job
) -> None:
    token = claimed(records, redis, job)
    store.folder(job.id).write_outcome(outcome(JobState.FAILED))
    assert reconcile(store, records, queue, 0.0).ended == (job.id,)
    assert state(records, job) is JobState.FAILED
    assert not records.renew(job.id, token, 30.0)


def test_a_cancellation_that_the_folder_did_not_hear_of(
    store: JobStore, records: JobRecords, queue: JobQueue, job: Job
) -> None:
    records.request_cancel(job.id)
    assert reconcile(store, records, queue, LONG_S).ended == (job.id,)
    found = store.folder(job.id).outcome()
    assert found is not None
    assert found.state is JobState.CANCELLED


def test_a_worker_that_died_while_cancelling(
    store: JobStore, records: JobRecords, queue: JobQueue, redis: Redis, job: Job
) -> None:
    claimed(records, redis, job, lease_s=0.5)
    records.request_cancel(job.id)
    assert not reconcile(store, records, queue, 0.0).is_something
    time.sleep(0.6)
    assert reconcile(store, records, queue, 0.0).ended == (job.id,)
    found = store.folder(job.id).outcome()
    assert found is not None
    assert found.state is state(records, job) is JobState.CANCELLED


def test_a_round_leaves_it_to_the_worker_what_a_cancellation_keeps(
    store: JobStore, records: JobRecords, queue: JobQueue, redis: Redis, job: Job
) -> None:
    claimed(records, redis, job)
    records.request_cancel(job.id, keeps_frames=True)
    assert not reconcile(store, records, queue, 0.0).is_something
    assert records.keeps_frames(job.id)


def test_an_end_on_disk_outranks_a_later_cancellation(
    store: JobStore, records: JobRecords, redis: Redis, job: Job
) -> None:
    """The worker wrote its outcome, lost its lease, and only then came the cancellation."""
    claimed(records, redis, job, lease_s=0.02)
    store.folder(job.id).write_outcome(outcome(JobState.SUCCEEDED))
    time.sleep(0.05)
    assert cancel(store.folder(job.id), records) is JobState.SUCCEEDED
    assert state(records, job) is JobState.SUCCEEDED


def test_a_record_without_a_folder_is_forgotten(
    store: JobStore, records: JobRecords, queue: JobQueue, job: Job
) -> None:
    store.folder(job.id).erase()
    assert reconcile(store, records, queue, LONG_S).forgotten == (job.id,)
    assert records.ids() == []


def test_erasing_while_reconciling_leaves_nothing(
    store: JobStore,
    records: JobRecords,
    queue: JobQueue,
    redis: Redis,
    make_request: Callable[[], JobRequest],
) -> None:
    requests = [make_request() for _ in range(40)]
    for request in requests:
        submit(store, records, queue, request, {})
    redis.flushall()
    stop = threading.Event()

    def keep_reconciling() -> None:
        while not stop.is_set():
            reconcile(store, records, queue, 0.0)

    reconcilers = [threading.Thread(target=keep_reconciling) for _ in range(2)]
    for thread in reconcilers:
        thread.start()
    for request in requests:
        erase(store.folder(request.job_id), records)
        erase(store.folder(request.job_id), records)
    stop.set()
    for thread in reconcilers:
        thread.join()
    assert remains(store) == []
    assert records.ids() == []


@pytest.mark.parametrize("error", [OSError("read-only"), StoreUnavailable("away")])
def test_what_attempts_left_is_tidied_after_a_death_and_holds_up_nobody(
    store: JobStore,
    records: JobRecords,
    queue: JobQueue,
    redis: Redis,
    job: Job,
    monkeypatch: pytest.MonkeyPatch,
    error: Exception,
) -> None:
    token = claimed(records, redis, job)
    folder = store.folder(job.id)
    folder.write_checkpoint("fit", b"after level 2")
    records.finished(job.id, token, folder.write_outcome(outcome(JobState.SUCCEEDED)))

    def failing(_: object) -> None:
        raise error

    settled = Settled()
    with monkeypatch.context() as patch:
        patch.setattr(type(folder), "tidy", failing)
        assert not reconcile(store, records, queue, LONG_S, settled).is_something
    assert folder.read_checkpoint("fit") is not None
    assert not reconcile(store, records, queue, LONG_S, settled).is_something
    assert folder.read_checkpoint("fit") is None
