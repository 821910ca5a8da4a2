"""A store on disk, records and queue in a real Redis, and requests to put there."""

from collections.abc import Callable, Iterator
from datetime import UTC, datetime
from pathlib import Path

import pytest
from redis import Redis

from jobs.queue import JobQueue
from jobs.records import JobRecords
from jobs.redis_client import make_redis
from jobs.settings import JobSettings
from jobs.store import JobStore
from schemas.job import JobKind
from schemas.messages import JobRequest
from tests.redis_server import RedisServer


@pytest.fixture(scope="session")
def redis_server(tmp_path_factory: pytest.TempPathFactory) -> Iterator[RedisServer]:
    server = RedisServer(tmp_path_factory.mktemp("redis"))
    server.start()
    yield server
    server.kill()


@pytest.fixture
def settings(redis_server: RedisServer, tmp_path: Path) -> JobSettings:
    return JobSettings(redis_url=redis_server.url, data_dir=tmp_path / "data", redis_timeout_s=1.0)


@pytest.fixture
def redis(settings: JobSettings) -> Iterator[Redis]:
    with make_redis(settings.redis_url, settings.redis_timeout_s) as client:
        client.flushall()
        yield client


@pytest.fixture
def store(settings: JobSettings) -> JobStore:
    return JobStore(settings.jobs_dir)


@pytest.fixture
def records(redis: Redis) -> JobRecords:
    return JobRecords(redis)


@pytest.fixture
def queue(settings: JobSettings, redis: Redis) -> JobQueue:
    return JobQueue(settings, redis)


@pytest.fixture
def make_request(store: JobStore) -> Callable[[], JobRequest]:
    def make() -> JobRequest:
        return JobRequest(
            job_id=store.new_id(), kind=JobKind.CONTOURS, created_at=datetime.now(tz=UTC)
        )

    return make


@pytest.fixture
def request_(make_request: Callable[[], JobRequest]) -> JobRequest:
    return make_request()
