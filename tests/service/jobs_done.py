"""What a worker leaves behind, without the work: results and outcomes for tests of the API."""

import hashlib
from datetime import UTC, datetime

from jobs.records import JobRecords
from jobs.store import JobStore
from schemas.artifacts import Artifact, Manifest
from schemas.job import JobState
from schemas.messages import Outcome
from schemas.vocabulary import Axes

MESH = bytes(range(256)) * 40
FILES = {
    "ED_lv_endo.stl": (MESH, "model/stl"),
    "report.json": (b'{"subject_id": "case-01"}', "application/json"),
    "report.html": (b"<!doctype html><title>case-01</title>", "text/html; charset=utf-8"),
}


def claim(records: JobRecords, job_id: str) -> int:
    token = records.claim(job_id, 60.0, 3).token
    assert token is not None
    return token


def finish(store: JobStore, records: JobRecords, job_id: str, state: JobState) -> None:
    """Take a queued job through a worker's steps to `state`."""
    token = claim(records, job_id)
    folder = store.folder(job_id)
    if state is JobState.SUCCEEDED:
        staging = folder.staging(token)
        for name, (content, _) in FILES.items():
            (staging / name).write_bytes(content)
        folder.publish(staging, _manifest())
    now = datetime.now(tz=UTC)
    outcome = Outcome(state=state, started_at=now, finished_at=now, attempt=1)
    records.finished(job_id, token, folder.write_outcome(outcome))


def _manifest() -> Manifest:
    return Manifest(
        subject_id="case-01",
        axes=Axes.LPS,
        created_at=datetime.now(tz=UTC),
        software="test",
        artifacts=[
            Artifact(
                name=name,
                media_type=media_type,
                bytes=len(content),
                sha256=hashlib.sha256(content).hexdigest(),
            )
            for name, (content, media_type) in FILES.items()
        ],
    )
