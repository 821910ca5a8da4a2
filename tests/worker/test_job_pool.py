"""A real worker's child: heartbeats leave it as it is, jobs wear it out."""

from collections.abc import Callable
from pathlib import Path
from typing import cast

import psutil
import pytest
from redis import Redis

from jobs.folder import JobFolder
from jobs.live_workers import LiveWorkers
from jobs.queue import JobQueue
from jobs.records import JobRecords
from schemas.job import JobState
from schemas.messages import ReconstructMessage
from tests.worker.test_heartbeat import running, until
from worker.settings import WorkerSettings

pytestmark = pytest.mark.integration

_JOBS = 2


@pytest.fixture
def workers(redis: Redis) -> LiveWorkers:
    return LiveWorkers(redis)


def child_of(worker_pid: int) -> int | None:
    """The process that computes; None while it is being replaced."""
    children = psutil.Process(worker_pid).children()
    return children[0].pid if len(children) == 1 else None


def test_a_child_is_replaced_after_its_jobs_and_not_after_heartbeats(
    redis: Redis,
    workers: LiveWorkers,
    settings: WorkerSettings,
    queue: JobQueue,
    records: JobRecords,
    queued_job: Callable[[], JobFolder],
    tmp_path: Path,
    monkeypatch: pytest.MonkeyPatch,
) -> None:
    monkeypatch.setenv("NEURALMRI_MAX_TASKS_PER_CHILD", str(_JOBS))
    log = tmp_path / "log"
    with running(settings, log, "--concurrency", "1") as worker:
        instants: set[str | None] = set()

        def are_many_finished() -> bool:
            instants.add(cast(str | None, redis.get("neuralmri:heartbeat")))
            return len(instants) > 3 * _JOBS

        until(lambda: workers.heartbeat_finished_ago_s() is not None, log)
        first = child_of(worker.pid)
        until(are_many_finished, log)
        assert child_of(worker.pid) == first is not None

        # Without anything to reconstruct: each fails, and is an attempt all the same.
        jobs = [queued_job().job_id for _ in range(_JOBS + 1)]
        for job_id in jobs[:_JOBS]:
            queue.enqueue(ReconstructMessage(job_id=job_id))
        until(lambda: child_of(worker.pid) not in (None, first), log, within_s=90.0)
        second = child_of(worker.pid)
        queue.enqueue(ReconstructMessage(job_id=jobs[-1]))

        def ended() -> bool:
            found = [records.get(job_id) for job_id in jobs]
            return all(job and job.state is JobState.FAILED for job in found)

        until(ended, log, within_s=90.0)
        assert child_of(worker.pid) == second
    assert "WorkerLost" not in log.read_text()
    assert worker.returncode == 0
