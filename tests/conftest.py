"""What tests of several rooms share: shape checks, a real Redis, and what works over it.

Array shapes and types are checked at run time in every test: see `worker/arrays.py`. A room that
uses `redis` and its kin has a fixture `settings` of its own.
"""

import os
from collections.abc import Iterator

import pytest
from redis import Redis

from jobs.disk_store import DiskStore
from jobs.open_store import open_store
from jobs.queue import JobQueue
from jobs.records import JobRecords
from jobs.redis_client import make_redis
from jobs.settings import JobSettings
from jobs.store import JobStore
from tests.redis_server import RedisServer
from tests.s3_server import BUCKET, S3Server
from tests.stores import empty_bucket

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
def store(settings: JobSettings) -> DiskStore:
    return DiskStore(settings.jobs_dir)


@pytest.fixture(scope="session")
def s3_server() -> Iterator[S3Server]:
    server = S3Server()
    server.start()
    with server.found():
        yield server
    server.stop()


@pytest.fixture
def bucket_store(s3_server: S3Server, settings: JobSettings) -> JobStore:
    """A store in an empty bucket."""
    empty_bucket(s3_server.url)
    return open_store(settings.model_copy(update={"store_url": f"s3://{BUCKET}/here"}))


@pytest.fixture(params=["disk", "bucket"])
def any_store(request: pytest.FixtureRequest) -> JobStore:
    """Each kind of store: what holds of it is a law of stores."""
    wanted = {"disk": "store", "bucket": "bucket_store"}[request.param]
    store: JobStore = request.getfixturevalue(wanted)
    return store


@pytest.fixture
def records(redis: Redis) -> JobRecords:
    return JobRecords(redis)


@pytest.fixture
def queue(settings: JobSettings, redis: Redis) -> JobQueue:
    return JobQueue(settings, redis)
