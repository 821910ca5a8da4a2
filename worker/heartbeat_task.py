"""The heartbeat that goes the way of a job: through the queue, into a child, to the job store."""

import logging
from functools import cache

from jobs import log_context
from jobs.live_workers import LiveWorkers
from jobs.log_context import LogContext
from jobs.open_store import open_store
from jobs.redis_client import make_redis
from jobs.store import JobStore
from schemas.messages import HEARTBEAT_TASK
from worker.app import app, settings

_LOGGER = logging.getLogger(__name__)


@app.task(name=HEARTBEAT_TASK, acks_late=False)  # type: ignore[untyped-decorator]  # celery ships no types
def finish_heartbeat() -> None:
    """Say that a child took this message and could leave results in the store, if it could."""
    log_context.enter(LogContext())
    store, workers = _reached()
    trouble = store.trouble()
    if trouble is None:
        workers.finished_heartbeat()
    else:
        _LOGGER.error("a heartbeat was not finished: the job store takes no file (%s)", trouble)


@cache
def _reached() -> tuple[JobStore, LiveWorkers]:
    """Made in the child: connections do not survive a fork."""
    redis = make_redis(settings.redis_url, settings.redis_timeout_s)
    return open_store(settings), LiveWorkers(redis)
