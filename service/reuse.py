"""An earlier job that has what a submission asks for."""

from datetime import UTC, datetime

from jobs.reusable import reusable
from schemas.job import Job, JobState
from schemas.messages import JobRequest
from service.access import JobAccess


def reusable_job(access: JobAccess, request: JobRequest, owner: str) -> Job | None:
    """The owner's newest job that succeeded with the same content by code that works here now.

    None where there is none, or no worker is alive to tell which code that is. Raises RedisError.
    """
    if request.content_sha256 is None:
        return None
    versions = access.workers.code_versions(access.settings.worker_alive_s)
    for job_id in reusable(access.redis, owner, request.content_sha256, versions):
        folder = access.store.folder(job_id)
        if access.owners.of(folder) != owner or folder.manifest() is None:
            continue
        job = access.records.get(job_id)
        if job is not None and job.state is JobState.SUCCEEDED and not _is_over(job):
            return job
    return None


def _is_over(job: Job) -> bool:
    return job.expires_at is not None and job.expires_at <= datetime.now(tz=UTC)
