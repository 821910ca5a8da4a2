"""How much work waits and is being done: hashes of unfinished jobs and the work that each asks for.

They are moved with the record, in its transaction, and hold as many jobs as may be unfinished.
"""

from bisect import bisect_left
from collections.abc import Mapping
from dataclasses import dataclass
from itertools import accumulate
from typing import cast

from redis import Redis
from redis.client import Pipeline

from jobs.record import Record
from schemas.job import Job, JobState, Priority

_HELD_KEY = "neuralmri:work:held"


def _line_key(priority: Priority) -> str:
    return f"neuralmri:work:{priority.value}"


def move_work(pipe: Pipeline, before: Record | None, after: Record | None) -> None:
    """Queue the commands that count a job's work where it now is."""
    old = _key(before) if before else None
    new = _key(after) if after else None
    if old == new:
        return
    if old and before:
        pipe.hdel(old, before.job_id)
    if new and after:
        pipe.hset(new, after.job_id, str(after.work))


def _key(record: Record) -> str | None:
    if record.state is JobState.QUEUED:
        return _line_key(record.priority)
    return None if record.state.is_terminal else _HELD_KEY


@dataclass(frozen=True)
class LineWork:
    """Work, in standard fits, as Redis has it now.

    lines: of the queued jobs of each priority, in their order: ids, and sums up to each.
    held: of each job that a worker has.
    """

    lines: Mapping[Priority, tuple[list[str], list[float]]]
    held: list[float]

    @classmethod
    def now(cls, redis: Redis) -> "LineWork":
        """Raises RedisError. No transaction: see `WaitingLine`."""
        with redis.pipeline(transaction=False) as pipe:
            for priority in Priority:
                pipe.hgetall(_line_key(priority))
            pipe.hvals(_HELD_KEY)
            *lines, held = pipe.execute()
        return cls(
            dict(zip(Priority, map(_summed, cast(list[dict[str, str]], lines)), strict=True)),
            [float(work) for work in cast(list[str], held)],
        )

    def mean_until(self, job: Job) -> float:
        """Of a job among those that are worked on or go before `job`; 1 where there are none."""
        before = [self._before(job, job.priority)]
        if job.priority is Priority.BATCH:
            ids, sums = self.lines[Priority.INTERACTIVE]
            before.append((len(ids), sums[-1]))
        count = len(self.held) + sum(count for count, _ in before)
        return (sum(self.held) + sum(work for _, work in before)) / count if count else 1.0

    def mean_held(self) -> float:
        """Of a job that is worked on; 1 where there is none."""
        return sum(self.held) / len(self.held) if self.held else 1.0

    def _before(self, job: Job, priority: Priority) -> tuple[int, float]:
        ids, sums = self.lines[priority]
        rank = bisect_left(ids, job.id)
        return rank, sums[rank]


def _summed(found: dict[str, str]) -> tuple[list[str], list[float]]:
    ids = sorted(found)
    return ids, list(accumulate((float(found[job_id]) for job_id in ids), initial=0.0))
