"""Sorted sets that list jobs by owner and state. Job ids sort by time, so the members' own order
is the order of creation, and a job id is a stable cursor.
"""

from redis.client import Pipeline

from jobs.record import Record
from schemas.job import JobState, Priority

ANY_OWNER = "*"


def index_key(owner: str, state: JobState | None = None) -> str:
    """The sorted set of an owner's jobs (ANY_OWNER: everybody's) in one state, or in any."""
    return f"neuralmri:jobs:{owner}:{state.value if state else 'any'}"


def record_key(job_id: str) -> str:
    """The hash of a job's record."""
    return f"neuralmri:job:{job_id}"


def batch_key(batch_id: str) -> str:
    """The sorted set of the jobs of one batch."""
    return f"neuralmri:batch:{batch_id}"


def line_key(priority: Priority) -> str:
    """The sorted set of the queued jobs of one priority."""
    return f"neuralmri:line:{priority.value}"


def move_in_index(pipe: Pipeline, before: Record | None, after: Record | None) -> None:
    """Queue the commands that take a job from where it was listed to where it belongs."""
    old = _keys(before) if before else set()
    new = _keys(after) if after else set()
    for key in sorted(old - new):
        pipe.zrem(key, before.job_id if before else "")
    for key in sorted(new - old):
        pipe.zadd(key, {after.job_id if after else "": 0})


def _keys(record: Record) -> set[str]:
    keys = {
        index_key(owner, state)
        for owner in (ANY_OWNER, record.owner)
        for state in (None, record.state)
    }
    if record.batch_id is not None:
        keys.add(batch_key(record.batch_id))
    return keys | {line_key(record.priority)} if record.state is JobState.QUEUED else keys
