from collections.abc import Callable, Iterator
from pathlib import Path

import pytest

from jobs.queue import JobQueue
from jobs.reconcile import reconcile
from jobs.records import JobRecords
from jobs.redis_client import make_redis
from jobs.settings import JobSettings
from jobs.store import JobStore
from jobs.submission import submit
from schemas.job import JobState
from schemas.messages import JobRequest, ReconstructMessage
from schemas.problem import InternalError, ProblemType
from tests.redis_server import RedisServer
from tests.stores import remains


@pytest.fixture
def store(any_store: JobStore) -> JobStore:
    return any_store


def test_folder_record_and_message(
    store: JobStore, records: JobRecords, queue: JobQueue, request_: JobRequest
) -> None:
    job = submit(store, records, queue, request_, {"sax.nii": b"x"})
    assert job.state is JobState.QUEUED
    assert store.folder(job.id).request() == request_
    assert records.get(job.id) == job
    assert queue.waiting() == {job.id}


@pytest.fixture
def dead_server(tmp_path: Path) -> Iterator[RedisServer]:
    server = RedisServer(tmp_path)
    server.start()
    server.kill()
    yield server
    server.kill()


@pytest.mark.parametrize("dead", ["records", "queue"])
def test_what_cannot_be_queued_is_not_accepted(
    dead: str,
    store: JobStore,
    records: JobRecords,
    queue: JobQueue,
    request_: JobRequest,
    dead_server: RedisServer,
) -> None:
    """Whether Redis is gone before the record or between record and message."""
    with make_redis(dead_server.url, 0.5) as nothing:
        if dead == "records":
            records = JobRecords(nothing)
        else:
            queue = JobQueue(JobSettings(redis_url=dead_server.url, redis_timeout_s=0.5), nothing)
        with pytest.raises(InternalError) as raised:
            submit(store, records, queue, request_, {})
    assert (raised.value.type, raised.value.status) == (ProblemType.UNAVAILABLE, 503)
    assert remains(store) == []


def test_a_store_that_fails_accepts_nothing(
    store: JobStore, records: JobRecords, queue: JobQueue, request_: JobRequest, tmp_path: Path
) -> None:
    with pytest.raises(FileNotFoundError):
        submit(store, records, queue, request_, {"sax.nii": tmp_path / "not there"})
    assert remains(store) == []
    assert records.get(request_.job_id) is None
    assert queue.waiting() == set()


class _QueueThatDies(JobQueue):
    """The process dies before the message is sent."""

    def enqueue(self, message: ReconstructMessage) -> None:
        raise KeyboardInterrupt


def test_a_crash_between_the_steps_leaves_a_whole_job(
    store: JobStore,
    records: JobRecords,
    queue: JobQueue,
    settings: JobSettings,
    make_request: Callable[[], JobRequest],
) -> None:
    request = make_request()
    with make_redis(settings.redis_url) as redis, pytest.raises(KeyboardInterrupt):
        submit(store, records, _QueueThatDies(settings, redis), request, {})
    assert queue.waiting() == set()
    reconcile(store, records, queue, lost_after_s=0.0)
    assert queue.waiting() == {request.job_id}
