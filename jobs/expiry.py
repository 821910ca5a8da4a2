"""When jobs are to be erased because they are old enough: their retention, from the end on.

Redis lists ended jobs by that instant, in the transaction that ends them; the folder has the last
word. A job that waits or is worked on never expires.
"""

from datetime import datetime, timedelta
from typing import cast

from redis import Redis
from redis.client import Pipeline

from jobs.record import Record
from schemas.messages import JobRequest, Outcome

_KEY = "neuralmri:expiry"


def move_expiry(pipe: Pipeline, before: Record | None, after: Record | None) -> None:
    """Queue the commands that list an ended job by its expiry, or take it from the list."""
    old = before.expires_at if before else None
    new = after.expires_at if after else None
    if old == new:
        return
    if new and after:
        pipe.zadd(_KEY, {after.job_id: new.timestamp()})
    elif before:
        pipe.zrem(_KEY, before.job_id)


def due(redis: Redis, now: datetime, limit: int) -> list[str]:
    """Ids of jobs that have expired, the first to do so first. Raises RedisError."""
    return cast(
        list[str],
        redis.zrangebyscore(_KEY, "-inf", now.timestamp(), start=0, num=limit),
    )


def expires_at(request: JobRequest, outcome: Outcome | None) -> datetime | None:
    """When a job expires, as its folder says; None for never, or not yet ended."""
    if outcome is None or request.retain_s is None:
        return None
    return outcome.finished_at + timedelta(seconds=request.retain_s)
