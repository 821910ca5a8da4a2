"""A worker whose engine takes no time: `celery --app benchmarks.stub_worker worker`.

Everything about it is the real worker's, save that a job's one artifact is a line of text.
"""

import hashlib
from datetime import UTC, datetime
from functools import cache
from pathlib import Path

import worker.task  # noqa: F401  registers the real task, which goes below
from jobs.folder import JobFolder
from jobs.open_store import open_store
from jobs.queue import JobQueue
from jobs.records import JobRecords
from jobs.redis_client import make_redis
from schemas.artifacts import Artifact, Manifest
from schemas.messages import RECONSTRUCT_TASK, ReconstructMessage
from schemas.vocabulary import Axes
from worker import shutdown_flag
from worker.app import app, settings
from worker.attempt import Desk, attempt
from worker.observer import KeepsFound, Observer

_NAME, _CONTENT = "note.txt", b"nothing was computed\n"

app.tasks.unregister(RECONSTRUCT_TASK)


@app.task(name=RECONSTRUCT_TASK)  # type: ignore[untyped-decorator]  # celery ships no types
def do_nothing(**message: str) -> None:
    """An attempt as the real task makes it."""
    attempt(ReconstructMessage.model_validate(message).job_id, _desk())


@cache
def _desk() -> Desk:
    redis = make_redis(settings.redis_url, settings.redis_timeout_s)
    return Desk(
        store=open_store(settings),
        records=JobRecords(redis),
        queue=JobQueue(settings, redis),
        settings=settings,
        produce=_produce,
        is_shutting_down=shutdown_flag.is_raised,
    )


def _produce(folder: JobFolder, out_dir: Path, _observer: Observer, _: KeepsFound) -> Manifest:
    (out_dir / _NAME).write_bytes(_CONTENT)
    sha256 = hashlib.sha256(_CONTENT).hexdigest()
    note = Artifact(name=_NAME, media_type="text/plain", bytes=len(_CONTENT), sha256=sha256)
    return Manifest(
        subject_id=folder.job_id,
        axes=Axes.LPS,
        created_at=datetime.now(UTC),
        software="stub",
        artifacts=[note],
    )
