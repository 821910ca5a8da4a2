"""A receiver, and a service that may send to loopback and tries again within the second.

It has a Redis of its own: the service that other tests share would hold the dispatcher's lock.
"""

from collections.abc import Callable, Iterator
from pathlib import Path
from typing import Any

import pytest
from redis import Redis

from service.settings import ServiceSettings
from tests.redis_server import RedisServer
from tests.service.conftest import Api
from tests.service.webhooks.receiver import Receiver, receiving

TO_LOOPBACK: dict[str, Any] = {
    "webhook_allow": "127.0.0.0/8",
    "webhook_http": True,
    "webhook_high_ports": True,
    "webhook_every_s": 0.05,
    "webhook_timeout_s": 2.0,
    "webhook_retry_s": "0,0.1,0.2,0.3",
}


@pytest.fixture(scope="session")
def hooks_redis_server(tmp_path_factory: pytest.TempPathFactory) -> Iterator[RedisServer]:
    server = RedisServer(tmp_path_factory.mktemp("hooks-redis"))
    server.start()
    yield server
    server.kill()


@pytest.fixture
def settings(hooks_redis_server: RedisServer, tmp_path: Path) -> ServiceSettings:
    return ServiceSettings(
        redis_url=hooks_redis_server.url,
        data_dir=tmp_path / "data",
        redis_timeout_s=1.0,
        reconcile_every_s=3600.0,
    )


@pytest.fixture
def receiver() -> Iterator[Receiver]:
    with receiving() as found:
        yield found


@pytest.fixture
def hook_settings(settings: ServiceSettings) -> ServiceSettings:
    return settings.model_copy(update=TO_LOOPBACK)


@pytest.fixture
def hooks(
    redis: Redis, hook_settings: ServiceSettings, serve: Callable[[ServiceSettings], Api]
) -> Api:
    """A service over an empty Redis and an empty data folder."""
    return serve(hook_settings)
