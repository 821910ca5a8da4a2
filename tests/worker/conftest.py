"""Settings over the shared Redis, and jobs that wait in store and records."""

from collections.abc import Callable
from datetime import UTC, datetime
from pathlib import Path

import pytest

from jobs.folder import JobFolder
from jobs.records import JobRecords
from jobs.store import JobStore
from schemas.job import JobKind
from schemas.messages import JobRequest
from tests.redis_server import RedisServer
from worker.settings import WorkerSettings


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
