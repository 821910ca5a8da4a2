"""Accepting a submission that was found good, and saying so."""

import logging
from collections.abc import Mapping

from fastapi import Response
from redis.exceptions import RedisError

from jobs.estimate import retry_after_s
from jobs.folder import Source
from jobs.submission import submit
from schemas.job import Job
from schemas.messages import JobRequest
from service.access import JobAccess

log = logging.getLogger("neuralmri.service")


def accept(
    access: JobAccess,
    request: JobRequest,
    inputs: Mapping[str, Source],
    owner: str,
    response: Response,
) -> Job:
    """Accept the job, and say in the headers where it is and when to look."""
    job = submit(access.store, access.records, access.queue, request, inputs, owner)
    job = _placed(access, job)
    _announce(job, response, access.settings.poll_after_s)
    return job


def _placed(access: JobAccess, job: Job) -> Job:
    """The job with its place in the line; without where Redis fails, since it is accepted."""
    try:
        return access.line.placed([job])[0]
    except RedisError as error:
        log.warning("job %s was accepted, its place is not known: %s", job.id, error)
        return job


def _announce(job: Job, response: Response, poll_after_s: int) -> None:
    wait_s = max(poll_after_s, job.estimated_start_s or 0.0)
    response.headers["Location"] = job.links.self
    response.headers["Retry-After"] = str(retry_after_s(wait_s, poll_after_s))
