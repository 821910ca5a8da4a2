"""Which jobs have succeeded with what content by which code: where a result is looked for again.

Listed and removed with the job's record, in its transaction. The list is a hint, and a part of it
may be missing while Redis is rebuilt from the folders; the folder has the last word.
"""

from collections.abc import Iterable
from typing import cast

from redis import Redis
from redis.client import Pipeline

from jobs.record import Record
from schemas.job import JobState


def move_reusable(pipe: Pipeline, before: Record | None, after: Record | None) -> None:
    """Queue the commands that list a job that has succeeded, or take it from the list."""
    old = _key_of(before) if before else None
    new = _key_of(after) if after else None
    if old == new:
        return
    if old and before:
        pipe.srem(old, before.job_id)
    if new and after:
        pipe.sadd(new, after.job_id)


def reusable(redis: Redis, owner: str, content: str, code_versions: Iterable[str]) -> list[str]:
    """Ids of an owner's jobs with these results, the newest first. Raises RedisError."""
    keys = [_key(owner, content, code_version) for code_version in code_versions]
    found = cast(set[str], redis.sunion(keys)) if keys else set()
    return sorted(found, reverse=True)


def _key_of(record: Record) -> str | None:
    if record.state is not JobState.SUCCEEDED or not record.content_sha256:
        return None
    if not record.code_version:
        return None
    return _key(record.owner, record.content_sha256, record.code_version)


def _key(owner: str, content: str, code_version: str) -> str:
    return f"neuralmri:results:{owner}:{content}:{code_version}"
