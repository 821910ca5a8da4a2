"""Accepting a job: folder, record, message, in this order, or nothing at all."""

from collections.abc import Mapping

from redis.exceptions import RedisError

from jobs import log_context
from jobs.folder import Source
from jobs.queue import JobQueue
from jobs.records import JobRecords
from jobs.store import JobStore
from schemas.job import Job
from schemas.messages import ANONYMOUS, JobRequest, ReconstructMessage
from schemas.problem import InternalError, ProblemType


def submit(
    store: JobStore,
    records: JobRecords,
    queue: JobQueue,
    request: JobRequest,
    inputs: Mapping[str, Source],
    owner: str = ANONYMOUS,
) -> Job:
    """Accept a job of `owner`.

    Once this returns, the job survives the loss of Redis and of this process.

    It is part of the current trace. Raises InternalError (unavailable) where Redis fails on the
    way. The folder is erased again, so that the caller may send the request anew without it being
    done twice. What Redis may have taken in spite of its silence is harmless: a worker that gets
    the message finds no folder and drops it, and the reconciler forgets records without a folder. A
    crash of this process between the steps leaves a whole folder; the reconciler then runs a job
    whose caller never learned its id.
    """
    context = log_context.current()
    context.job_id = request.job_id
    traceparent = context.trace.header() if context.trace else None
    request = request.model_copy(update={"owner": owner, "traceparent": traceparent})
    folder = store.folder(request.job_id)
    folder.create(request, inputs)
    try:
        records.accepted(request)
        message = ReconstructMessage(
            job_id=request.job_id, priority=request.priority, traceparent=traceparent
        )
        queue.enqueue(message)
        job = records.get(request.job_id)
    except (RedisError, InternalError) as error:
        folder.erase()
        raise InternalError(
            ProblemType.UNAVAILABLE,
            "the queue cannot be reached; nothing was accepted, send the request again in a while",
            status=503,
        ) from error
    if job is None:
        raise InternalError(
            ProblemType.UNAVAILABLE,
            "the job was erased while it was being accepted; send the request again",
            status=503,
        )
    return job
