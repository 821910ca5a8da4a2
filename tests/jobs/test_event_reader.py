"""Reading from any place: what follows it, exactly, or the job as it stands."""

import asyncio
import json
from typing import Any

import pytest
from redis import Redis

from jobs import event_stream
from jobs.event_id import START, EventId
from jobs.event_reader import EventBatch, EventReader, StoredEvent
from jobs.event_stream import events_key
from jobs.records import JobRecords
from jobs.redis_client import make_async_redis
from jobs.settings import JobSettings
from schemas.event import EventKind
from schemas.job import JobState, Progress
from schemas.messages import JobRequest
from tests.jobs.test_records import claimed, outcome


class Reading:
    """The reader, asked from outside of an event loop."""

    def __init__(self, url: str) -> None:
        self._url = url

    def batch(self, job_id: str, after: EventId = START) -> EventBatch | None:
        async def ask() -> EventBatch | None:
            async with make_async_redis(self._url) as redis:
                return await EventReader(redis).read(job_id, after)

        return asyncio.run(ask())

    def all(self, job_id: str, after: EventId = START) -> tuple[list[StoredEvent], bool]:
        """Everything after an event, batch by batch, and whether it is the end."""
        events: list[StoredEvent] = []
        while batch := self.batch(job_id, after):
            events += batch.events
            if batch.is_whole:
                return events, batch.is_last
            after = events[-1].id
        raise AssertionError("Redis does not know the job")


@pytest.fixture
def reading(settings: JobSettings) -> Reading:
    return Reading(settings.redis_url)


@pytest.fixture
def job_id(records: JobRecords, request_: JobRequest) -> str:
    records.accepted(request_)
    return request_.job_id


def lived(records: JobRecords, job_id: str, steps: int, end: JobState | None) -> int:
    token = claimed(records, job_id)
    for step in range(steps):
        records.advanced(job_id, token, Progress(iteration=step, fraction=step / steps))
    if end is not None:
        records.finished(job_id, token, outcome(end))
    return token


def job_of(event: StoredEvent) -> Any:
    assert event.kind is EventKind.STATE
    return json.loads(event.data)


@pytest.mark.parametrize("end", [None, JobState.SUCCEEDED])
@pytest.mark.parametrize("steps", [0, 5, 98, 230])
def test_from_every_event_follows_exactly_the_rest(
    records: JobRecords, reading: Reading, job_id: str, steps: int, end: JobState | None
) -> None:
    lived(records, job_id, steps, end)
    events, is_last = reading.all(job_id)
    assert is_last == (end is not None)
    assert len(events) == 2 + steps + is_last
    ids = [event.id for event in events]
    assert ids == sorted(set(ids))
    some = range(len(ids)) if steps < 10 else (0, 1, len(ids) // 2, len(ids) - 2, len(ids) - 1)
    for place in some:
        assert reading.all(job_id, ids[place]) == (events[place + 1 :], is_last)


def test_an_end_is_last_and_told_once(records: JobRecords, reading: Reading, job_id: str) -> None:
    lived(records, job_id, 3, JobState.FAILED)
    events, _ = reading.all(job_id)
    assert job_of(events[-1])["state"] == "failed"
    assert reading.batch(job_id, events[-1].id) == EventBatch((), is_whole=True, is_last=True)


def test_an_unknown_job(reading: Reading, redis: Redis) -> None:
    assert reading.batch("0" * 32) is None


def test_who_comes_too_late_for_the_beginning_gets_the_job_as_it_stands(
    records: JobRecords, reading: Reading, job_id: str, monkeypatch: pytest.MonkeyPatch
) -> None:
    monkeypatch.setattr(event_stream, "MAX_EVENTS", 100)
    first, _ = reading.all(job_id)
    token = lived(records, job_id, 400, None)
    for after in (START, first[0].id):
        (standing,), is_last = reading.all(job_id, after)
        assert not is_last
        assert job_of(standing)["state"] == "running"
        assert job_of(standing)["progress"]["iteration"] == 399
    records.advanced(job_id, token, Progress(iteration=400))
    (following,), _ = reading.all(job_id, standing.id)
    assert json.loads(following.data)["iteration"] == 400


@pytest.mark.parametrize("end", [None, JobState.CANCELLED])
def test_an_id_from_the_future_gets_the_job_as_it_stands(
    records: JobRecords, reading: Reading, job_id: str, end: JobState | None
) -> None:
    if end:
        records.request_cancel(job_id)
    batch = reading.batch(job_id, EventId(2**63, 0))
    assert batch is not None
    (standing,) = batch.events
    assert job_of(standing)["state"] == ("cancelled" if end else "queued")
    assert batch.is_last == (end is not None)
    assert standing.id == reading.all(job_id)[0][-1].id


def test_when_redis_forgot_and_was_told_again_the_new_beginning_follows(
    records: JobRecords, reading: Reading, redis: Redis, request_: JobRequest, job_id: str
) -> None:
    lived(records, job_id, 3, None)
    seen, _ = reading.all(job_id)
    redis.flushall()
    assert reading.batch(job_id, seen[-1].id) is None
    records.restore(request_, None)
    following, is_last = reading.all(job_id, seen[-1].id)
    assert [job_of(event)["state"] for event in following] == ["queued"]
    assert not is_last


def test_long_after_its_end_a_job_tells_its_end_once(
    records: JobRecords, reading: Reading, redis: Redis, job_id: str
) -> None:
    lived(records, job_id, 3, JobState.SUCCEEDED)
    seen, _ = reading.all(job_id)
    redis.delete(events_key(job_id))
    for after in (START, seen[1].id, seen[-1].id):
        (standing,), is_last = reading.all(job_id, after)
        assert is_last
        assert job_of(standing)["state"] == "succeeded"
    assert reading.all(job_id, standing.id) == ([], True)


def test_a_job_older_than_event_streams_is_told_once_and_then_followed(
    records: JobRecords, reading: Reading, redis: Redis, job_id: str
) -> None:
    redis.delete(events_key(job_id))
    (standing,), is_last = reading.all(job_id)
    assert job_of(standing)["state"] == "queued"
    assert not is_last
    assert reading.all(job_id, standing.id) == ([], False)
    claimed(records, job_id)
    (following,), _ = reading.all(job_id, standing.id)
    assert job_of(following)["state"] == "running"
    assert following.id > standing.id


def test_states(records: JobRecords, settings: JobSettings, job_id: str) -> None:
    async def states() -> list[JobState | None]:
        async with make_async_redis(settings.redis_url) as redis:
            reader = EventReader(redis)
            return [await reader.state(id_) for id_ in (job_id, "0" * 32)]

    assert asyncio.run(states()) == [JobState.QUEUED, None]
