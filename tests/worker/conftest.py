"""A store on disk, records and queue in a real Redis, and jobs waiting in both."""

from collections.abc import Callable, Iterator
from datetime import UTC, datetime
from pathlib import Path

import pytest
from redis import Redis

from jobs.folder import JobFolder
from jobs.queue import JobQueue
from jobs.records import JobRecords
from jobs.redis_client import make_redis
from jobs.store import JobStore
from schemas.job import JobKind
from schemas.messages import JobRequest
from tests.redis_server import RedisServer
from worker.settings import WorkerSettings


@pytest.fixture(scope="session")
def redis_server(tmp_path_factory: pytest.TempPathFactory) -> Iterator[RedisServer]:
    server = RedisServer(tmp_path_factory.mktemp("redis"))
    server.start()
    yield server
    server.kill()


@pytest.fixture
def settings(redis_server: RedisServer, tmp_path: Path) -> WorkerSettings:
    return WorkerSettings(
        redis_url=redis_server.url,
        data_dir=tmp_path / "data",
        redis_timeout_s=1.0,
        lease_s=1.0,
        lost_after_s=0.5,
    )


@pytest.fixture
def redis(settings: WorkerSettings) -> Iterator[Redis]:
    with make_redis(settings.redis_url, settings.redis_timeout_s) as client:
        client.flushall()
        yield client


@pytest.fixture
def store(settings: WorkerSettings) -> JobStore:
    return JobStore(settings.jobs_dir)


@pytest.fixture
def records(redis: Redis) -> JobRecords:
    return JobRecords(redis)


@pytest.fixture
def queue(settings: WorkerSettings, redis: Redis) -> JobQueue:
    return JobQueue(settings, redis)


@pytest.fixture
def queued_job(store: JobStore, records: JobRecords) -> Callable[[], JobFolder]:
    """Makes a job that is known to folder and record, as after a submission."""

    def make() -> JobFolder:
        request = JobRequest(
            job_id=store.new_id(), kind=JobKind.CONTOURS, created_at=datetime.now(UTC)
        )
        folder = store.folder(request.job_id)
        folder.create(request, {})
        records.accepted(request)
        return folder

    return make


@pytest.fixture
def folder(queued_job: Callable[[], JobFolder]) -> JobFolder:
    return queued_job()
