"""Ends that no worker brings about: cancellation and erasure."""

import logging

from redis.exceptions import RedisError

from jobs.errors import JobGone
from jobs.folder import JobFolder
from jobs.records import JobRecords
from schemas.job import Job, JobState
from schemas.messages import Outcome

_LOGGER = logging.getLogger(__name__)


def cancel(
    folder: JobFolder, records: JobRecords, *, keeps_frames: bool | None = False
) -> JobState | None:
    """Ask a job to stop; where none works on it, it is cancelled now and its folder says so.

    keeps_frames: The frames that its worker has finished by then are its results; None: as the
    last cancellation had it.

    Returns where the job stands, None for an unknown one. Idempotent: doing it again mends what a
    crash in between left.
    """
    state = records.request_cancel(folder.job_id, keeps_frames=keeps_frames)
    if state is None or not state.is_terminal:
        return state
    job = records.get(folder.job_id)
    if job is None:
        return None
    return settle(folder, records, job)


def settle(folder: JobFolder, records: JobRecords, job: Job) -> JobState | None:
    """Make folder and record of an ended job agree; what the folder says first stands."""
    outcome = folder.outcome()
    if outcome is None:
        try:
            outcome = folder.write_outcome(
                Outcome(
                    state=job.state,
                    started_at=job.started_at,
                    finished_at=job.finished_at or job.created_at,
                    attempt=job.attempt,
                    error=job.error,
                )
            )
        except JobGone:
            records.forget(folder.job_id)
            return None
    # Of a job that was handed back, or whose worker died.
    folder.drop_checkpoints()
    if outcome.state is not job.state:
        # A worker that had lost its lease ended the job before the cancellation reached the disk.
        records.restore(folder.request(), outcome)
    return outcome.state


def erase(folder: JobFolder, records: JobRecords) -> None:
    """Remove a job: its worker is told to stop, inputs and results go, then the record.

    In this order, so that a record without a folder always means an erased job. Redis is not
    needed: one that fails may be waiting for the very space that this frees. The reconciler forgets
    the record then, and the worker finds its lease lost. Idempotent.
    """
    try:
        try:
            records.request_cancel(folder.job_id)
        finally:
            folder.erase()
        records.forget(folder.job_id)
    except RedisError as error:
        _LOGGER.warning("job %s was erased, its record not yet: %s", folder.job_id, error)
