"""Stands in for a worker: each job ends at once, with the results of one real reconstruction."""

import shutil
import tempfile
import threading
from collections.abc import Iterator
from contextlib import AbstractContextManager, contextmanager
from datetime import UTC, datetime
from pathlib import Path
from types import TracebackType
from typing import Self

from redis.exceptions import RedisError

from jobs.disk_store import DiskStore
from jobs.errors import JobGone, StaleToken
from jobs.live_workers import LiveWorkers
from jobs.records import JobRecords
from jobs.redis_client import make_redis
from jobs.settings import JobSettings
from schemas.artifacts import Manifest
from schemas.job import JobState
from schemas.messages import ContourRequest, Outcome
from service.examples import CONTOUR_REQUEST
from worker.subject import run

_LOOK_EVERY_S = 0.02
_LEASE_S = 60.0
_QUICK = {
    "preset": "fast",
    "levels": 1,
    "iterations_per_level": 5,
    "mesh": {"grid_mm": 4},
    "formats": ["stl"],
}


class QuickEngine(AbstractContextManager["QuickEngine"]):
    """A thread that claims what is queued, oldest first, as a worker does, and publishes.

    Jobs of a caller who cancels are cancelled; jobs that are erased meanwhile are let go.
    """

    def __init__(self, settings: JobSettings) -> None:
        redis = make_redis(settings.redis_url, settings.redis_timeout_s)
        self._store = DiskStore(settings.jobs_dir)
        self._records = JobRecords(redis)
        self._workers = LiveWorkers(redis)
        self._stop = threading.Event()
        self._turn = threading.Lock()
        self._thread = threading.Thread(target=self._work, name="quick-engine")
        self._results = Path(tempfile.mkdtemp(prefix="results-", dir=settings.data_dir))
        self._manifest = _one_result(self._results)

    def __enter__(self) -> Self:
        self._beat()
        self._thread.start()
        return self

    def __exit__(
        self,
        kind: type[BaseException] | None,
        error: BaseException | None,
        trace: TracebackType | None,
    ) -> None:
        self._stop.set()
        self._thread.join()

    @contextmanager
    def paused(self) -> Iterator[None]:
        """Meanwhile jobs wait; one that it is at is ended first."""
        with self._turn:
            yield

    def _work(self) -> None:
        while not self._stop.wait(_LOOK_EVERY_S):
            try:
                self._beat()
                with self._turn:
                    if job_id := self._records.oldest(JobState.QUEUED):
                        self._end(job_id)
            except (RedisError, JobGone, StaleToken, FileNotFoundError):
                continue  # erased or cancelled between two steps: the next look shows

    def _beat(self) -> None:
        self._workers.heartbeat("quick-engine")
        self._workers.finished_heartbeat()

    def _end(self, job_id: str) -> None:
        claim = self._records.claim(job_id, _LEASE_S, max_attempts=3)
        if claim.token is None:
            return
        folder = self._store.folder(job_id)
        state = JobState.SUCCEEDED
        if self._records.is_cancel_requested(job_id):
            state = JobState.CANCELLED
        else:
            staging = folder.staging(claim.token)
            for path in self._results.iterdir():
                shutil.copyfile(path, staging / path.name)
            folder.publish(staging, self._manifest)
        now = datetime.now(UTC)
        outcome = Outcome(
            state=state, started_at=claim.started_at, finished_at=now, attempt=claim.attempt
        )
        self._records.finished(job_id, claim.token, folder.write_outcome(outcome))


def _one_result(out_dir: Path) -> Manifest:
    request = ContourRequest.model_validate({**CONTOUR_REQUEST, "options": _QUICK})
    finished = run(request.study, request.options, out_dir, threads=1, input_sha256="0" * 64)
    return finished.manifest
