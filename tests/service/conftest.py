"""A real server on loopback over a real Redis, and a client of it."""

import shutil
import threading
import time
from collections.abc import Callable, Iterator
from contextlib import ExitStack, contextmanager
from dataclasses import dataclass
from pathlib import Path

import httpx
import pytest
import uvicorn
from redis import Redis

from jobs.live_workers import LiveWorkers
from jobs.open_store import open_store
from jobs.records import JobRecords
from jobs.redis_client import make_redis
from jobs.store import JobStore
from schemas.api_key import Scope
from service.app import create_app
from service.keys import keyring
from service.keys.key_file import KeyFile
from service.settings import ServiceSettings
from tests.redis_server import RedisServer, free_port
from tests.s3_server import BUCKET, S3Server
from tests.stores import empty_bucket


@dataclass(frozen=True)
class Api:
    """A running service, and what is behind it."""

    client: httpx.Client
    settings: ServiceSettings
    store: JobStore
    records: JobRecords
    workers: LiveWorkers
    redis: Redis


def _settings(redis_server: RedisServer, data_dir: Path) -> ServiceSettings:
    return ServiceSettings(
        redis_url=redis_server.url,
        data_dir=data_dir,
        redis_timeout_s=1.0,
        reconcile_every_s=3600.0,
        refusals_per_minute=0,  # all tests come from one address
    )


@contextmanager
def serving(settings: ServiceSettings) -> Iterator[Api]:
    """A service on a free port."""
    port = free_port()
    server = uvicorn.Server(
        uvicorn.Config(
            create_app(settings), host="127.0.0.1", port=port, log_level="error", ws="none"
        )
    )
    thread = threading.Thread(target=server.run)
    thread.start()
    try:
        while not server.started:
            assert thread.is_alive(), "the server did not start"
            time.sleep(0.01)
        with (
            httpx.Client(base_url=f"http://127.0.0.1:{port}", timeout=20.0) as client,
            make_redis(settings.redis_url) as redis,
        ):
            yield Api(
                client,
                settings,
                open_store(settings),
                JobRecords(redis),
                LiveWorkers(redis),
                redis,
            )
    finally:
        server.should_exit = True
        thread.join(timeout=20.0)


@pytest.fixture
def settings(redis_server: RedisServer, tmp_path: Path) -> ServiceSettings:
    return _settings(redis_server, tmp_path / "data")


@pytest.fixture
def serve() -> Iterator[Callable[[ServiceSettings], Api]]:
    """Start a service with settings of its own; it is stopped after the test."""
    with ExitStack() as stack:
        yield lambda settings: stack.enter_context(serving(settings))


@pytest.fixture(scope="session")
def shared_api(
    redis_server: RedisServer, tmp_path_factory: pytest.TempPathFactory
) -> Iterator[Api]:
    with serving(_settings(redis_server, tmp_path_factory.mktemp("service"))) as api:
        yield api


@pytest.fixture
def api(shared_api: Api, redis_server: RedisServer) -> Api:
    """A service without jobs: one server for all tests, emptied before each."""
    with make_redis(redis_server.url) as redis:
        redis.flushall()
    shutil.rmtree(shared_api.settings.jobs_dir)
    shared_api.settings.jobs_dir.mkdir()
    return shared_api


@pytest.fixture(scope="session")
def shared_bucket_api(
    s3_server: S3Server, redis_server: RedisServer, tmp_path_factory: pytest.TempPathFactory
) -> Iterator[Api]:
    settings = _settings(redis_server, tmp_path_factory.mktemp("bucket-service"))
    # Its first round of the reconciler finds a bucket.
    empty_bucket(s3_server.url)
    with serving(settings.model_copy(update={"store_url": f"s3://{BUCKET}"})) as api:
        yield api


@pytest.fixture
def bucket_api(shared_bucket_api: Api, s3_server: S3Server, redis_server: RedisServer) -> Api:
    """A service without jobs, over a bucket."""
    with make_redis(redis_server.url) as redis:
        redis.flushall()
    empty_bucket(s3_server.url)
    return shared_bucket_api


@pytest.fixture(params=["disk", "bucket"])
def any_api(request: pytest.FixtureRequest) -> Api:
    """A service over each kind of store."""
    wanted = {"disk": "api", "bucket": "bucket_api"}[request.param]
    api: Api = request.getfixturevalue(wanted)
    return api


@pytest.fixture
def keyed(settings: ServiceSettings, serve: Callable[[ServiceSettings], Api]) -> Api:
    """A service that asks for keys, since one exists."""
    file = KeyFile(settings.data_dir)
    keyring.create(file, "the first", "first", (Scope.READ,), None)
    return serve(settings)
