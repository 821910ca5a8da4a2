"""What has happened since Redis began, counted: ends, attempts, lost workers, time by stage.

Each step on a record adds what it means in the transaction that takes it, so that nothing is
counted twice or lost with a process. A Redis that has forgotten everything counts from nothing, as
a counter may; jobs that are then restored at their end are not counted again.
"""

from collections import Counter, defaultdict
from collections.abc import Iterator
from dataclasses import dataclass
from typing import cast

from redis import Redis
from redis.client import Pipeline

from jobs.durations import Durations, bucket
from jobs.record import Record
from schemas.job import JobState, Stage

_KEY = "neuralmri:tallies"

_NO_FAULT = "none"


@dataclass(frozen=True)
class Totals:
    """Everything counted.

    ended: jobs by kind, state and fault (`caller`, `service`, `none`). attempts: begun by a worker.
    workers_lost: attempts that were taken from their worker because its lease ran out; of jobs that
    are being cancelled, none. expired: jobs erased for their age. stages: durations by stage, of
    the attempts that ended their job.
    """

    ended: dict[tuple[str, str, str], int]
    attempts: int
    workers_lost: int
    expired: int
    stages: dict[str, Durations]


class Tallies:
    """Reads what was counted."""

    def __init__(self, redis: Redis) -> None:
        self._redis = redis

    def totals(self) -> Totals:
        """Raises RedisError."""
        counted = cast(dict[str, str], self._redis.hgetall(_KEY))
        ended: dict[tuple[str, str, str], int] = {}
        buckets: dict[str, dict[int, int]] = defaultdict(dict)
        sums: dict[str, float] = defaultdict(float)
        for name, value in counted.items():
            match name.split("|"):
                case ["ended", kind, state, fault]:
                    ended[kind, state, fault] = int(value)
                case ["stage", stage, "sum"]:
                    sums[stage] = float(value)
                case ["stage", stage, place]:
                    buckets[stage][int(place)] = int(value)
        return Totals(
            ended=ended,
            attempts=int(counted.get("attempts", 0)),
            workers_lost=int(counted.get("workers_lost", 0)),
            expired=int(counted.get("expired", 0)),
            stages={stage: Durations(buckets[stage], sums[stage]) for stage in buckets},
        )

    def count_expired(self) -> None:
        """A job was erased because it had expired. Raises RedisError."""
        self._redis.hincrby(_KEY, "expired", 1)


def tally(pipe: Pipeline, before: Record | None, after: Record | None) -> None:
    """Queue the commands that count a step."""
    if before is None or after is None:
        return
    for name, count in Counter(_happened(before, after)).items():
        pipe.hincrby(_KEY, name, count)
    for stage, seconds in _took(before, after):
        pipe.hincrby(_KEY, f"stage|{stage.value}|{bucket(seconds)}", 1)
        pipe.hincrbyfloat(_KEY, f"stage|{stage.value}|sum", seconds)


def _happened(before: Record, after: Record) -> Iterator[str]:
    if after.attempt > before.attempt:
        yield "attempts"
    if before.state is JobState.RUNNING and (
        (after.state is JobState.QUEUED and after.attempt == before.attempt)
        or (after.state is JobState.RUNNING and after.attempt > before.attempt)
        or after.state is JobState.CANCELLED
    ):
        yield "workers_lost"
    if _has_ended(before, after):
        fault = after.error.fault.value if after.error else _NO_FAULT
        yield f"ended|{after.kind.value}|{after.state.value}|{fault}"


def _took(before: Record, after: Record) -> Iterator[tuple[Stage, float]]:
    if before.started_at is None and after.started_at is not None:
        # The one is the service's clock and the other Redis's.
        waited_s = (after.started_at - after.created_at).total_seconds()
        yield Stage.WAITING, max(0.0, waited_s)
    if _has_ended(before, after):
        yield from after.stage_s.items()


def _has_ended(before: Record, after: Record) -> bool:
    return after.state.is_terminal and not before.state.is_terminal
