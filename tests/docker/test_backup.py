"""The backup that docs/deploy.md tells of, made by its own command and restored."""

import re
import stat
import subprocess
from datetime import UTC, datetime
from pathlib import Path

import pytest
from redis import Redis

from jobs.disk_store import DiskStore
from jobs.queue import JobQueue
from jobs.reconcile import reconcile
from jobs.records import JobRecords
from jobs.settings import JobSettings
from schemas.job import JobKind, JobState
from schemas.messages import JobRequest
from tests.redis_server import RedisServer

DEPLOY = Path(__file__).parents[2] / "docs" / "deploy.md"


@pytest.fixture
def settings(redis_server: RedisServer, tmp_path: Path) -> JobSettings:
    return JobSettings(redis_url=redis_server.url, data_dir=tmp_path / "data", redis_timeout_s=1.0)


def test_a_restored_backup_brings_the_jobs_back_and_nothing_half_made(
    settings: JobSettings,
    store: DiskStore,
    records: JobRecords,
    queue: JobQueue,
    redis: Redis,
    tmp_path: Path,
) -> None:
    request = JobRequest(job_id=store.new_id(), kind=JobKind.CONTOURS, created_at=datetime.now(UTC))
    folder = store.folder(request.job_id)
    folder.create(request, {"sax.nii": b"a map"})
    records.accepted(request)
    (folder.path / "staging-1").mkdir()
    (store.root / ".new-abc").mkdir()
    keys = settings.data_dir / "keys.json"
    keys.touch(0o600)

    found = re.search(r"^data=.*\n(tar --create .*\\\n.*)$", DEPLOY.read_text(), re.MULTILINE)
    assert found
    command = found[1].replace("/backup/", f"{tmp_path}/")
    subprocess.run(
        ["sh", "-ec", f'data="{settings.data_dir}"\n{command}'], check=True, capture_output=True
    )
    (backup,) = tmp_path.glob("neuralmri-*.tar.gz")
    restored = tmp_path / "restored"
    restored.mkdir()
    subprocess.run(
        ["tar", "--extract", "--preserve-permissions", "--file", backup, "--directory", restored],
        check=True,
    )

    redis.flushall()
    store = DiskStore(restored / "jobs")
    assert [path.name for path in store.root.iterdir()] == [request.job_id]
    assert not list(store.root.glob("*/staging-*"))
    assert store.folder(request.job_id).request() == request
    assert stat.S_IMODE((restored / "keys.json").stat().st_mode) == 0o600
    assert reconcile(store, records, queue, 30.0).restored == (request.job_id,)
    job = records.get(request.job_id)
    assert job is not None
    assert job.state is JobState.QUEUED
