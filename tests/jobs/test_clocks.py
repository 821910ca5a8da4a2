"""The clock of Redis, or of a host, jumps by an hour or a day: no job is lost, none waits for long.

What Redis reads from its own clock inside a script is played by keys as a jump would leave them.
"""

import time
from collections.abc import Callable
from datetime import UTC, datetime

import pytest
from redis import Redis

from jobs import live_workers
from jobs import records as records_module
from jobs.admission import Admission, Verdict
from jobs.batch_turn import give_batch_turn
from jobs.claim import Refusal
from jobs.disk_store import DiskStore
from jobs.live_workers import LiveWorkers
from jobs.queue import JobQueue
from jobs.reconcile import reconcile
from jobs.records import JobRecords
from jobs.redis_clock import now_us
from jobs.runtimes import seconds_per_work
from jobs.submission import submit
from schemas.job import Job, JobState, Priority, Stage
from schemas.messages import JobRequest, Outcome
from tests.redis_server import RedisServer

HOUR_S, DAY_S, LEASE_S, LOST_AFTER_S = 3600.0, 86400.0, 30.0, 30.0

back = pytest.mark.parametrize("by_s", [-HOUR_S, -DAY_S], ids=["an hour back", "a day back"])
either = pytest.mark.parametrize(
    "by_s",
    [-HOUR_S, -DAY_S, HOUR_S, DAY_S],
    ids=["an hour back", "a day back", "an hour on", "a day on"],
)


class Clock:
    """The clock of Redis as Python sees it, which a test moves."""

    def __init__(self) -> None:
        self.ahead_s = 0.0

    def now_us(self, redis: Redis) -> int:
        return now_us(redis) + int(self.ahead_s * 1e6)

    def jump(self, by_s: float) -> None:
        self.ahead_s += by_s

    pass_ = jump
    """Time that passes is no different."""


@pytest.fixture
def clock(monkeypatch: pytest.MonkeyPatch) -> Clock:
    clock = Clock()
    for module in (records_module, live_workers):
        monkeypatch.setattr(module, "now_us", clock.now_us)
    return clock


@pytest.fixture
def job(store: DiskStore, records: JobRecords, queue: JobQueue, request_: JobRequest) -> Job:
    return submit(store, records, queue, request_, {})


def taken(records: JobRecords, redis: Redis, job: Job) -> int:
    redis.lpop("neuralmri")
    token = records.claim(job.id, LEASE_S, 3).token
    assert token is not None
    return token


def ended(state: JobState = JobState.SUCCEEDED, **stage_s: float) -> Outcome:
    now = datetime.now(tz=UTC)
    return Outcome(
        state=state,
        started_at=now,
        finished_at=now,
        attempt=1,
        stage_s={Stage(stage): seconds for stage, seconds in stage_s.items()},
    )


@either
def test_a_waiting_job_can_be_claimed(
    records: JobRecords, clock: Clock, job: Job, by_s: float
) -> None:
    clock.jump(by_s)
    assert records.claim(job.id, LEASE_S, 3).granted


@either
def test_a_lost_message_is_sent_again(
    store: DiskStore,
    records: JobRecords,
    queue: JobQueue,
    redis: Redis,
    clock: Clock,
    job: Job,
    by_s: float,
) -> None:
    redis.delete("neuralmri")
    clock.jump(by_s)
    reconcile(store, records, queue, LOST_AFTER_S)
    clock.pass_(LOST_AFTER_S + 1.0)
    reconcile(store, records, queue, LOST_AFTER_S)
    assert queue.waiting() == {job.id}


@back
def test_a_worker_that_lives_keeps_its_job_when_the_clock_goes_back(
    store: DiskStore,
    records: JobRecords,
    queue: JobQueue,
    redis: Redis,
    clock: Clock,
    job: Job,
    by_s: float,
) -> None:
    token = taken(records, redis, job)
    clock.jump(by_s)
    for _ in range(5):
        assert not reconcile(store, records, queue, LOST_AFTER_S).is_something
        clock.pass_(LEASE_S / 3)
        assert records.renew(job.id, token, LEASE_S)
        assert records.claim(job.id, LEASE_S, 3).refusal is Refusal.HELD
    records.finished(job.id, token, store.folder(job.id).write_outcome(ended()))


@either
def test_a_worker_that_dies_about_a_jump_is_missed_soon(
    store: DiskStore,
    records: JobRecords,
    queue: JobQueue,
    redis: Redis,
    clock: Clock,
    job: Job,
    by_s: float,
) -> None:
    taken(records, redis, job)
    clock.jump(by_s)
    sent = list(reconcile(store, records, queue, LOST_AFTER_S).enqueued)
    clock.pass_(LEASE_S + LOST_AFTER_S + 1.0)
    sent += reconcile(store, records, queue, LOST_AFTER_S).enqueued
    assert sent == [job.id]
    assert records.claim(job.id, LEASE_S, 3).attempt == 2


@pytest.mark.parametrize("by_s", [HOUR_S, DAY_S])
def test_a_clock_that_goes_on_costs_a_running_job_one_attempt_at_most(
    store: DiskStore,
    records: JobRecords,
    queue: JobQueue,
    redis: Redis,
    clock: Clock,
    job: Job,
    by_s: float,
) -> None:
    token = taken(records, redis, job)
    clock.jump(by_s)
    assert reconcile(store, records, queue, LOST_AFTER_S).enqueued == (job.id,)
    assert not records.renew(job.id, token, LEASE_S), "it stops, and writes nothing more"
    again = taken(records, redis, job)
    for _ in range(5):
        assert not reconcile(store, records, queue, LOST_AFTER_S).is_something
        clock.pass_(LEASE_S / 3)
        assert records.renew(job.id, again, LEASE_S)


@pytest.mark.parametrize("by_s", [HOUR_S, DAY_S])
def test_who_renews_before_anybody_looks_keeps_its_job(
    store: DiskStore,
    records: JobRecords,
    queue: JobQueue,
    redis: Redis,
    clock: Clock,
    job: Job,
    by_s: float,
) -> None:
    token = taken(records, redis, job)
    clock.jump(by_s)
    assert records.renew(job.id, token, LEASE_S)
    assert not reconcile(store, records, queue, LOST_AFTER_S).is_something


@back
def test_a_fence_of_before_the_jump_is_stale_even_where_redis_forgot_it(
    store: DiskStore,
    records: JobRecords,
    queue: JobQueue,
    redis: Redis,
    clock: Clock,
    job: Job,
    by_s: float,
) -> None:
    old = taken(records, redis, job)
    redis.flushall()
    clock.jump(by_s)
    reconcile(store, records, queue, LOST_AFTER_S)
    new = taken(records, redis, job)
    assert new < old
    assert not records.renew(job.id, old, LEASE_S)
    assert records.renew(job.id, new, LEASE_S)


@either
def test_cancelling_ends_soon(
    store: DiskStore,
    records: JobRecords,
    queue: JobQueue,
    redis: Redis,
    clock: Clock,
    job: Job,
    by_s: float,
) -> None:
    taken(records, redis, job)
    records.request_cancel(job.id)
    clock.jump(by_s)
    reconcile(store, records, queue, LOST_AFTER_S)
    clock.pass_(LEASE_S + 1.0)
    reconcile(store, records, queue, LOST_AFTER_S)
    found = records.get(job.id)
    assert found is not None
    assert found.state is JobState.CANCELLED


@back
def test_the_dead_do_not_look_alive_when_the_clock_goes_back(
    redis: Redis, clock: Clock, by_s: float
) -> None:
    workers = LiveWorkers(redis)
    for name in ("dead@host", "alive@host"):
        workers.heartbeat(name)
    workers.finished_heartbeat()
    clock.jump(by_s)
    assert workers.names(30.0) == []
    assert workers.heartbeat_finished_ago_s() is None, "another is asked for"
    workers.heartbeat("alive@host")
    workers.finished_heartbeat()
    assert workers.names(30.0) == ["alive@host"]
    assert workers.slots(30.0) == 1
    assert workers.heartbeat_finished_ago_s() == pytest.approx(0.0, abs=1.0)


@pytest.mark.parametrize("by_s", [HOUR_S, DAY_S])
def test_the_living_are_seen_again_with_their_next_heartbeat(
    redis: Redis, clock: Clock, by_s: float
) -> None:
    workers = LiveWorkers(redis)
    workers.heartbeat("alive@host", slots=3)
    clock.jump(by_s)
    assert workers.names(30.0) == []
    workers.heartbeat("alive@host", slots=3)
    assert workers.slots(30.0) == 3


@either
def test_estimates_are_of_what_workers_measured(
    records: JobRecords, redis: Redis, clock: Clock, job: Job, by_s: float
) -> None:
    token = taken(records, redis, job)
    clock.jump(by_s)
    records.finished(job.id, token, ended(fitting=20.0, meshing=5.0))
    assert seconds_per_work(redis) == 25.0


@back
def test_a_clock_that_went_back_has_measured_nothing(
    records: JobRecords, redis: Redis, clock: Clock, job: Job, by_s: float
) -> None:
    token = taken(records, redis, job)
    clock.jump(by_s)
    records.finished(job.id, token, ended())
    assert seconds_per_work(redis) is None


def test_ids_grow_whatever_the_clock_of_their_host_does(
    store: DiskStore, monkeypatch: pytest.MonkeyPatch
) -> None:
    now_ns = time.time_ns()
    ids = []
    for ahead_s in (0.0, HOUR_S, -DAY_S, 0.0, DAY_S, -HOUR_S):
        monkeypatch.setattr(time, "time_ns", lambda ahead_s=ahead_s: now_ns + int(ahead_s * 1e9))
        ids += [store.new_id() for _ in range(3)]
    assert sorted(set(ids)) == ids


def test_jobs_of_a_host_with_another_clock_are_listed_once_each(
    records: JobRecords,
    monkeypatch: pytest.MonkeyPatch,
    store: DiskStore,
    make_request: Callable[[], JobRequest],
) -> None:
    """A host that started over after its clock went back makes ids that sort before older ones."""
    known = []
    for ahead_s in (0.0, DAY_S, -DAY_S):
        now_ns = time.time_ns() + int(ahead_s * 1e9)
        with monkeypatch.context() as patch:
            patch.setattr(time, "time_ns", lambda now_ns=now_ns: now_ns)
            request = make_request().model_copy(update={"job_id": DiskStore(store.root).new_id()})
        records.accepted(request)
        known.append(request.job_id)
    seen, cursor = [], None
    while True:
        page = records.page("anonymous", limit=1, cursor=cursor)
        seen += [job.id for job in page.jobs]
        cursor = page.next_cursor
        if cursor is None:
            break
    assert sorted(seen) == sorted(known)


def test_a_batch_job_has_its_turn_whatever_the_clock_of_its_host_said(
    store: DiskStore,
    records: JobRecords,
    queue: JobQueue,
    redis: Redis,
    make_request: Callable[[], JobRequest],
) -> None:
    ahead = f"{int((time.time() + DAY_S) * 1000):012x}{'0' * 20}"
    request = make_request().model_copy(update={"priority": Priority.BATCH, "job_id": ahead})
    submit(store, records, queue, request, {})
    assert not give_batch_turn(redis, 30.0), "it came this instant"
    time.sleep(0.02)
    assert give_batch_turn(redis, 0.01)


@pytest.mark.parametrize("since_s", [HOUR_S, DAY_S])
def test_a_batch_job_has_its_turn_when_the_clock_of_redis_goes_back(
    store: DiskStore,
    records: JobRecords,
    queue: JobQueue,
    redis: Redis,
    make_request: Callable[[], JobRequest],
    since_s: float,
) -> None:
    job = submit(
        store, records, queue, make_request().model_copy(update={"priority": Priority.BATCH}), {}
    )
    redis.hset(f"neuralmri:job:{job.id}", "free_from_us", now_us(redis) + int(since_s * 1e6))
    redis.set("neuralmri:batch-turn", "1", ex=int(since_s))
    assert give_batch_turn(redis, 30.0)
    assert not give_batch_turn(redis, 30.0), "no two within the time"


@pytest.mark.parametrize("ahead_s", [HOUR_S, DAY_S])
def test_a_place_that_nobody_took_is_free_again_soon_when_the_clock_goes_back(
    redis: Redis, make_request: Callable[[], JobRequest], ahead_s: float
) -> None:
    admission = Admission(redis, max_queued_jobs=1, max_jobs_per_owner=None)
    left = make_request()
    assert admission.ask(left, "anonymous").verdict is Verdict.ADMITTED
    for key in ("neuralmri:places", "neuralmri:places:anonymous"):
        redis.zadd(key, {left.job_id: now_us(redis) / 1000 + ahead_s * 1000})
    assert admission.ask(make_request(), "anonymous").verdict is Verdict.QUEUE_FULL
    for key in ("neuralmri:places", "neuralmri:places:anonymous"):
        until_ms = redis.zscore(key, left.job_id)
        assert isinstance(until_ms, float)
        assert until_ms / 1000 - now_us(redis) / 1e6 <= 120.0


@either
def test_what_is_compared_between_hosts_is_by_one_clock(
    records: JobRecords, redis: Redis, clock: Clock, job: Job, by_s: float
) -> None:
    clock.jump(by_s)
    taken(records, redis, job)
    started = records.get(job.id)
    assert started is not None
    assert started.started_at is not None
    assert 0.0 <= (records.now() - started.started_at).total_seconds() < HOUR_S / 2


def test_without_redis_the_time_is_by_this_hosts_clock(
    records: JobRecords, redis_server: RedisServer
) -> None:
    redis_server.kill()
    try:
        assert abs((records.now() - datetime.now(tz=UTC)).total_seconds()) < 60.0
    finally:
        redis_server.start()
