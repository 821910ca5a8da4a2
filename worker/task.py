"""The task that is a job: a message names it, and one attempt is made on it."""

from functools import cache, partial
from typing import Any

from jobs import log_context
from jobs.log_context import LogContext
from jobs.open_store import open_store
from jobs.queue import JobQueue
from jobs.records import JobRecords
from jobs.redis_client import make_redis
from jobs.trace_context import TraceContext
from schemas.messages import RECONSTRUCT_TASK, ReconstructMessage
from worker import shutdown_flag, wear
from worker.app import app, code, settings
from worker.attempt import Desk, attempt


@app.task(name=RECONSTRUCT_TASK, bind=True)  # type: ignore[untyped-decorator]  # celery ships no types
def reconstruct(task: Any, **message: str) -> None:
    """Make one attempt on the job that the message names."""
    wear.OF_THIS_PROCESS.note_job()
    job_id = ReconstructMessage.model_validate(message).job_id
    traceparent = (task.request.headers or {}).get("traceparent")
    log_context.enter(LogContext(job_id=job_id, trace=TraceContext.parsed(traceparent)))
    attempt(job_id, _desk())


@cache
def _desk() -> Desk:
    """Made in the child at its first job: connections do not survive a fork."""
    # The way to the science: here, so that the parent never loads it.
    from worker.produce import produce

    redis = make_redis(settings.redis_url, settings.redis_timeout_s)
    return Desk(
        store=open_store(settings),
        records=JobRecords(redis),
        queue=JobQueue(settings, redis),
        settings=settings,
        produce=partial(
            produce,
            threads=settings.threads,
            processes=settings.processes,
            limits=settings.limits(),
        ),
        is_shutting_down=shutdown_flag.is_raised,
        code_version=code,
    )
