import time
from collections.abc import Callable
from datetime import UTC, datetime

import pytest
from redis import Redis

from jobs.live_workers import LiveWorkers
from jobs.records import JobRecords
from jobs.runtimes import seconds_per_work
from jobs.waiting_line import WaitingLine
from schemas.job import Job, JobState, Priority
from schemas.messages import JobRequest, Outcome

Accept = Callable[..., str]


@pytest.fixture
def line(redis: Redis) -> WaitingLine:
    return WaitingLine(redis, LiveWorkers(redis), 30.0)


@pytest.fixture
def accept(records: JobRecords, make_request: Callable[[], JobRequest]) -> Accept:
    def one(priority: Priority = Priority.INTERACTIVE, work: float = 1.0) -> str:
        request = make_request().model_copy(update={"priority": priority, "work": work})
        records.accepted(request)
        return request.job_id

    return one


def outcome(state: JobState, attempt: int = 1) -> Outcome:
    now = datetime.now(tz=UTC)
    return Outcome(state=state, started_at=now, finished_at=now, attempt=attempt)


def done(records: JobRecords, job_id: str, runtime_s: float) -> None:
    token = records.claim(job_id, 60.0, 3).token
    assert token is not None
    time.sleep(runtime_s)
    records.finished(job_id, token, outcome(JobState.SUCCEEDED))


def placed(line: WaitingLine, records: JobRecords, *job_ids: str) -> list[Job]:
    jobs = [job for job_id in job_ids if (job := records.get(job_id)) is not None]
    return line.placed(jobs)


def positions(line: WaitingLine, records: JobRecords, *job_ids: str) -> list[int | None]:
    return [job.queue_position for job in placed(line, records, *job_ids)]


def test_places_are_by_priority_and_then_by_age(
    line: WaitingLine, records: JobRecords, accept: Accept
) -> None:
    batch = [accept(Priority.BATCH) for _ in range(2)]
    interactive = [accept() for _ in range(3)]
    assert positions(line, records, *interactive, *batch) == [0, 1, 2, 3, 4]
    records.claim(interactive[0], 60.0, 3)
    records.request_cancel(batch[0])
    assert positions(line, records, *interactive, *batch) == [None, 0, 1, None, 2]
    records.reclaimed(interactive[0], -100.0)
    assert positions(line, records, interactive[0]) == [0], "waiting again, and the oldest"
    for job_id in (*interactive, *batch):
        records.forget(job_id)
    assert line.redis.keys("neuralmri:line:*") == []


def test_no_estimate_without_a_worker_or_a_measured_runtime(
    line: WaitingLine, records: JobRecords, accept: Accept
) -> None:
    first, second = accept(), accept()
    assert placed(line, records, second)[0].estimated_start_s is None
    done(records, first, 0.0)
    assert placed(line, records, second)[0].estimated_start_s is None
    assert line.next_start_s() is None
    line.workers.heartbeat("worker@host")
    assert placed(line, records, second)[0].estimated_start_s == 0.0


def test_estimates_grow_along_the_line_and_shrink_with_workers(
    line: WaitingLine, records: JobRecords, accept: Accept
) -> None:
    done(records, accept(), 0.5)
    line.workers.heartbeat("worker@host")
    running = accept()
    records.claim(running, 60.0, 3)
    waiting = [accept(Priority.BATCH), *(accept() for _ in range(4))]
    order = [*waiting[1:], waiting[0]]
    one = [job.estimated_start_s for job in placed(line, records, *order)]
    assert one == pytest.approx([0.5, 1.0, 1.5, 2.0, 2.5], rel=0.2)
    assert line.next_start_s() == one[0]
    line.workers.heartbeat("other@host", slots=2)
    three = [job.estimated_start_s for job in placed(line, records, *order)]
    assert three[:2] == [0.0, 0.0], "two slots are free"
    assert all(a <= b for a, b in zip(three, one, strict=True))
    assert placed(line, records, running)[0].estimated_start_s is None


def test_estimates_follow_the_work_that_jobs_ask_for(
    redis: Redis, line: WaitingLine, records: JobRecords, accept: Accept
) -> None:
    """One pace, 2 s a standard fit, serves a quick and a thorough job, whichever was measured."""
    redis.rpush("neuralmri:seconds-per-work", "2.0")
    line.workers.heartbeat("worker@host")
    running = accept(work=4.0)
    records.claim(running, 60.0, 3)
    quick, thorough, last = accept(work=0.25), accept(work=10.0), accept()
    batch = accept(Priority.BATCH)
    told = [j.estimated_start_s for j in placed(line, records, quick, thorough, last, batch)]
    assert told == pytest.approx([8.0, 8.5, 28.5, 30.5])
    assert line.next_start_s() == 8.0
    records.request_cancel(thorough)
    assert placed(line, records, last)[0].estimated_start_s == 8.5
    for job_id in (running, quick, thorough, last, batch):
        records.forget(job_id)
    assert redis.keys("neuralmri:work:*") == []


def test_the_pace_is_time_by_work(redis: Redis, records: JobRecords, accept: Accept) -> None:
    done(records, accept(work=4.0), 0.4)
    assert seconds_per_work(redis) == pytest.approx(0.1, rel=0.2)


def test_only_what_a_worker_did_in_one_go_is_a_runtime(
    redis: Redis, records: JobRecords, accept: Accept
) -> None:
    assert seconds_per_work(redis) is None
    failed, lost, told, retried = (accept() for _ in range(4))
    token = records.claim(failed, 60.0, 3).token
    assert token is not None
    records.finished(failed, token, outcome(JobState.FAILED))
    records.claim(told, 60.0, 3)
    records.restore(JobRequest.model_validate(_request(told)), outcome(JobState.SUCCEEDED))
    records.claim(retried, 0.0, 3)
    done(records, retried, 0.0)
    handed_back = accept()
    token = records.claim(handed_back, 60.0, 3).token
    assert token is not None
    records.released(handed_back, token)
    done(records, handed_back, 0.0)
    assert seconds_per_work(redis) is None
    done(records, lost, 0.2)
    done(records, accept(), 0.4)
    assert seconds_per_work(redis) == pytest.approx(0.3, rel=0.2)


def test_an_end_that_is_said_twice_is_one_runtime(
    redis: Redis, records: JobRecords, accept: Accept
) -> None:
    job_id = accept()
    token = records.claim(job_id, 60.0, 3).token
    assert token is not None
    end = outcome(JobState.SUCCEEDED)
    records.finished(job_id, token, end)
    records.finished(job_id, token, end)
    assert redis.llen("neuralmri:seconds-per-work") == 1


def test_old_runtimes_are_forgotten(redis: Redis, records: JobRecords, accept: Accept) -> None:
    redis.rpush("neuralmri:seconds-per-work", *["1000.0"] * 60)
    for _ in range(50):
        done(records, accept(), 0.0)
    assert redis.llen("neuralmri:seconds-per-work") == 50
    found = seconds_per_work(redis)
    assert found is not None
    assert found < 1.0


def _request(job_id: str) -> dict[str, object]:
    return {"job_id": job_id, "kind": "contours", "created_at": datetime.now(tz=UTC)}
