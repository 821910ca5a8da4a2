"""Settings over the shared Redis, and requests to submit."""

from collections.abc import Callable
from datetime import UTC, datetime
from pathlib import Path

import pytest

from jobs.settings import JobSettings
from jobs.store import JobStore
from schemas.job import JobKind
from schemas.messages import JobRequest
from tests.redis_server import RedisServer


@pytest.fixture
def settings(redis_server: RedisServer, tmp_path: Path) -> JobSettings:
    return JobSettings(redis_url=redis_server.url, data_dir=tmp_path / "data", redis_timeout_s=1.0)


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
