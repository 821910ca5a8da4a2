"""Reading a job's events from any place, without gaps that the reader does not learn of."""

import asyncio
from collections.abc import Mapping
from dataclasses import dataclass
from typing import Any, cast

from redis.asyncio import Redis

from jobs.event_id import LARGEST, START, EventId
from jobs.event_stream import events_key
from jobs.index import record_key
from jobs.record import Record
from schemas.event import EventKind
from schemas.job import JobState

_AT_ONCE = 100
_CONNECTIONS = 4

_Entry = tuple[str, dict[str, str]]


@dataclass(frozen=True)
class StoredEvent:
    """An event as its stream has it: `data` is JSON."""

    id: EventId
    kind: EventKind
    data: str


@dataclass(frozen=True)
class EventBatch:
    """The next events, in order.

    is_whole: whether these are all there are now. is_last: whether nothing will ever follow.
    """

    events: tuple[StoredEvent, ...]
    is_whole: bool
    is_last: bool


class EventReader:
    """Reads streams and states over a few connections, however many readers share it.

    Every method raises redis.exceptions.RedisError.
    """

    def __init__(self, redis: Redis) -> None:
        self._redis = redis
        self._free = asyncio.Semaphore(_CONNECTIONS)

    async def read(self, job_id: str, after: EventId) -> EventBatch | None:
        """What happened after an event; None where Redis does not know the job.

        Where what followed `after` is no longer kept, or `after` is of no stream that there is,
        one `state` event stands in for it: the job as it is, by the id of the newest event.
        """
        key = events_key(job_id)
        async with self._free, self._redis.pipeline() as pipe:
            pipe.hgetall(record_key(job_id))
            pipe.xrange(key, count=1)
            pipe.xrevrange(key, count=1)
            pipe.xrange(key, min=f"({after}", count=_AT_ONCE)
            pipe.time()
            fields, first, last, following, (now_s, _) = await pipe.execute()
        if not fields:
            return None
        record = Record.of_fields(job_id, cast(Mapping[str, str], fields))
        if not first:
            return _without_stream(record, after, now_s)
        return _after(record, after, first[0], last[0], following)

    async def state(self, job_id: str) -> JobState | None:
        """Where a job stands; None where Redis does not know it."""
        async with self._free:
            state = await cast(Any, self._redis.hget(record_key(job_id), "state"))
        return JobState(state) if state else None


def _after(
    record: Record, after: EventId, first: _Entry, last: _Entry, following: list[_Entry]
) -> EventBatch:
    oldest, newest = _id(first), _id(last)
    is_whole_stream = "begins" in first[1]
    if after > newest or (after < oldest and not is_whole_stream):
        events: tuple[StoredEvent, ...] = (_standing(record, newest),)
    else:
        events = tuple(
            StoredEvent(_id(entry), EventKind(entry[1]["event"]), entry[1]["data"])
            for entry in following
        )
    reached = events[-1].id if events else after
    is_whole = reached == newest
    return EventBatch(events, is_whole, is_last=is_whole and record.state.is_terminal)


def _without_stream(record: Record, after: EventId, now_s: int) -> EventBatch:
    """A job that ended long ago, or one that is older than event streams are."""
    is_last = record.state.is_terminal
    if record.finished_at is not None:
        standing = EventId(int(record.finished_at.timestamp() * 1000), LARGEST)
        told = after == standing
    else:
        # Below every id that Redis may still give.
        standing = EventId(now_s * 1000 - 1, 0)
        told = after != START
    return EventBatch(() if told else (_standing(record, standing),), True, is_last)


def _standing(record: Record, id_: EventId) -> StoredEvent:
    return StoredEvent(id_, EventKind.STATE, record.job().model_dump_json())


def _id(entry: _Entry) -> EventId:
    id_ = EventId.of_text(entry[0])
    if id_ is None:
        raise ValueError(f"Redis gave {entry[0]!r} for the id of an event")
    return id_
