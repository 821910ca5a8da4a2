"""How fast work was done lately, as measured: what estimates of waiting are made from.

Seconds by the work that a job asked for, so that quick and thorough jobs make one figure.
"""

from typing import cast

from redis import Redis
from redis.client import Pipeline

from jobs.record import Record
from schemas.job import JobState

_KEY = "neuralmri:seconds-per-work"
_KEPT = 50


def note_runtime(pipe: Pipeline, before: Record | None, after: Record | None, now_us: int) -> None:
    """Queue the commands that note a runtime, where this step is a worker's success.

    The worker has measured it, by a clock that does not jump. Where it says nothing, its token is
    the instant of its claim by the Redis clock, and its own end keeps it; a clock that went back
    meanwhile has measured nothing. Later attempts are left out, and those on a job that was
    handed back: they confirm, or go on with, what an earlier one has done.
    """
    if (
        before
        and after
        and (before.state, after.state) == (JobState.RUNNING, JobState.SUCCEEDED)
        and before.attempt == 1
        and not before.was_released
        and before.token == after.token
    ):
        runtime_s = sum(after.stage_s.values()) or (now_us - before.token) / 1e6
        if runtime_s >= 0.0:
            pipe.lpush(_KEY, f"{runtime_s / before.work:.6g}")
            pipe.ltrim(_KEY, 0, _KEPT - 1)


def seconds_per_work(redis: Redis) -> float | None:
    """Mean time of a standard fit of one frame, of the last jobs; None before the first.

    Raises RedisError.
    """
    found = [float(text) for text in cast(list[str], redis.lrange(_KEY, 0, -1))]
    return sum(found) / len(found) if found else None
