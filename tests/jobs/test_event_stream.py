"""Each step on a job is told once, with the step itself."""

import json
import threading
import time
from collections.abc import Callable
from typing import Any, cast

import pytest
from redis import Redis

from jobs import event_stream
from jobs.event_stream import EVENT_CHANNEL, events_key
from jobs.records import JobRecords
from schemas.job import Job, JobState, Progress, Stage
from schemas.messages import JobRequest
from tests.jobs.test_records import claimed, outcome

MakeRequest = Callable[[], JobRequest]


@pytest.fixture
def job_id(records: JobRecords, request_: JobRequest) -> str:
    records.accepted(request_)
    return request_.job_id


def told(redis: Redis, job_id: str) -> list[tuple[str, Any]]:
    entries = cast(Any, redis.xrange(events_key(job_id)))
    return [(fields["event"], json.loads(fields["data"])) for _, fields in entries]


def states(redis: Redis, job_id: str) -> list[str]:
    return [data["state"] for event, data in told(redis, job_id) if event == "state"]


def test_a_life_is_told_in_order(records: JobRecords, redis: Redis, job_id: str) -> None:
    token = claimed(records, job_id)
    steps = [Progress(stage=Stage.FITTING, fraction=f, level=1, loss=0.5) for f in (0.1, 0.2)]
    for step in steps:
        records.advanced(job_id, token, step)
    records.finished(job_id, token, outcome(JobState.SUCCEEDED))
    events = told(redis, job_id)
    assert [event for event, _ in events] == ["state", "state", "progress", "progress", "state"]
    assert [Progress.model_validate(data) for _, data in events[2:4]] == steps
    assert states(redis, job_id) == ["queued", "running", "succeeded"]
    assert Job.model_validate(events[-1][1]) == records.get(job_id)


def test_what_changes_nothing_for_the_caller_is_not_told(
    records: JobRecords, redis: Redis, request_: JobRequest, job_id: str
) -> None:
    token = claimed(records, job_id)
    progress = Progress(stage=Stage.READING)
    records.advanced(job_id, token, progress)
    records.finished(job_id, token, outcome(JobState.SUCCEEDED))
    before = told(redis, job_id)
    records.finished(job_id, token, outcome(JobState.SUCCEEDED))
    records.accepted(request_)
    records.restore(request_, outcome(JobState.SUCCEEDED))
    records.request_cancel(job_id)
    records.claim(job_id, 30.0, 3)
    assert told(redis, job_id) == before


def test_saying_the_same_twice_and_renewing_are_not_told(
    records: JobRecords, redis: Redis, job_id: str
) -> None:
    token = claimed(records, job_id)
    for _ in range(3):
        records.advanced(job_id, token, Progress(stage=Stage.READING))
        assert records.renew(job_id, token, 30.0)
    assert [event for event, _ in told(redis, job_id)] == ["state", "state", "progress"]


def test_a_new_attempt_is_told(records: JobRecords, redis: Redis, job_id: str) -> None:
    claimed(records, job_id, lease_s=0.02)
    time.sleep(0.05)
    claimed(records, job_id)
    attempts = [(data["state"], data["attempt"]) for _, data in told(redis, job_id)]
    assert attempts == [("queued", 0), ("running", 1), ("running", 2)]


def test_of_many_at_once_each_step_is_told_once(
    records: JobRecords, redis: Redis, job_id: str
) -> None:
    token = claimed(records, job_id)
    start = threading.Barrier(6)

    def work(lane: int) -> None:
        start.wait()
        for step in range(20):
            records.advanced(job_id, token, Progress(level=lane, iteration=step))
            records.request_cancel(job_id)

    threads = [threading.Thread(target=work, args=(lane,)) for lane in range(6)]
    for thread in threads:
        thread.start()
    for thread in threads:
        thread.join()
    steps = [(d["level"], d["iteration"]) for event, d in told(redis, job_id) if event != "state"]
    assert sorted(steps) == [(lane, step) for lane in range(6) for step in range(20)]
    assert states(redis, job_id) == ["queued", "running", "cancelling"]


def test_the_stream_is_capped(
    records: JobRecords, redis: Redis, job_id: str, monkeypatch: pytest.MonkeyPatch
) -> None:
    monkeypatch.setattr(event_stream, "MAX_EVENTS", 100)
    token = claimed(records, job_id)
    for step in range(400):
        records.advanced(job_id, token, Progress(iteration=step))
    # Redis drops whole nodes of a hundred.
    assert 100 <= redis.xlen(events_key(job_id)) <= 200
    assert told(redis, job_id)[-1][1]["iteration"] == 399


def test_it_expires_some_time_after_the_end_only(
    records: JobRecords, redis: Redis, job_id: str
) -> None:
    token = claimed(records, job_id)
    assert redis.ttl(events_key(job_id)) == -1
    records.finished(job_id, token, outcome(JobState.FAILED))
    left_s = redis.ttl(events_key(job_id))
    assert event_stream.KEPT_AFTER_END_S - 5 <= left_s <= event_stream.KEPT_AFTER_END_S


def test_the_folder_overruling_the_record_is_told(
    records: JobRecords, redis: Redis, request_: JobRequest
) -> None:
    records.restore(request_, outcome(JobState.SUCCEEDED))
    assert states(redis, request_.job_id) == ["succeeded"]
    records.restore(request_, outcome(JobState.FAILED))
    assert states(redis, request_.job_id) == ["succeeded", "failed"]


def test_each_event_rings(records: JobRecords, redis: Redis, job_id: str) -> None:
    with redis.pubsub(ignore_subscribe_messages=True) as channel:
        channel.subscribe(EVENT_CHANNEL)
        channel.get_message(timeout=5.0)
        token = claimed(records, job_id)
        records.renew(job_id, token, 30.0)
        records.advanced(job_id, token, Progress(fraction=0.5))
        records.forget(job_id)
        rung = [channel.get_message(timeout=5.0) for _ in range(3)]
        assert [message and message["data"] for message in rung] == [job_id] * 3
        assert channel.get_message(timeout=0.1) is None
