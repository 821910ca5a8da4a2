"""What tests of several rooms share: shape checks, a real Redis, and what works over it.

Array shapes and types are checked at run time in every test: see `worker/arrays.py`. A room that
uses `redis` and its kin has a fixture `settings` of its own.
"""

import os
from collections.abc import Iterator

import pytest
from redis import Redis

from jobs.queue import JobQueue
from jobs.records import JobRecords
from jobs.redis_client import make_redis
from jobs.settings import JobSettings
from jobs.store import JobStore
from tests.redis_server import RedisServer

# Before numpy or torch is loaded: one thread, so that results do not depend on the machine.
for variable in ("OMP_NUM_THREADS", "MKL_NUM_THREADS", "OPENBLAS_NUM_THREADS"):
    os.environ.setdefault(variable, "1")

from jaxtyping import install_import_hook  # noqa: E402  the threads must be set before

install_import_hook("worker", "beartype.beartype")


@pytest.fixture(scope="session")
def redis_server(tmp_path_factory: pytest.TempPathFactory) -> Iterator[RedisServer]:
    server = RedisServer(tmp_path_factory.mktemp("redis"))
    server.start()
    yield server
    server.kill()


@pytest.fixture
def redis(settings: JobSettings) -> Iterator[Redis]:
    """A client of the Redis in `settings`, which is emptied first."""
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
