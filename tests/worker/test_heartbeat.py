"""A real worker process, and what its heartbeats prove."""

import os
import sys
import time
from collections.abc import Callable, Iterator
from contextlib import contextmanager
from functools import partial
from pathlib import Path
from subprocess import DEVNULL, Popen

import psutil
import pytest
from redis import Redis

from jobs.live_workers import LiveWorkers
from jobs.queue import JobQueue
from schemas.job import Priority
from schemas.messages import HEARTBEAT_QUEUE, RECONSTRUCT_QUEUE, ReconstructMessage
from worker.parent_death import die_with_parent
from worker.settings import WorkerSettings

pytestmark = pytest.mark.integration

_ALIVE_S = 0.5


@pytest.fixture
def workers(redis: Redis) -> LiveWorkers:
    return LiveWorkers(redis)


@pytest.fixture
def log(tmp_path: Path) -> Path:
    return tmp_path / "log"


@contextmanager
def running(settings: WorkerSettings, log: Path, *arguments: str) -> Iterator["Popen[bytes]"]:
    command = ["celery", "--app", "worker.app", "--quiet", "worker", "--without-mingle"]
    with log.open("wb") as output:
        process = Popen(
            [sys.executable, "-m", *command, *arguments],
            env={
                **os.environ,
                "NEURALMRI_REDIS_URL": settings.redis_url,
                "NEURALMRI_DATA_DIR": str(settings.data_dir),
                "NEURALMRI_WORKER_ALIVE_S": str(_ALIVE_S),
                "NEURALMRI_HEARTBEAT_EVERY_S": "0.1",
            },
            stdin=DEVNULL,
            stdout=output,
            stderr=output,
            preexec_fn=partial(die_with_parent, os.getpid()),
        )
    try:
        yield process
    finally:
        process.terminate()
        process.wait(timeout=30)


@pytest.fixture
def worker(workers: LiveWorkers, settings: WorkerSettings, log: Path) -> Iterator["Popen[bytes]"]:
    """Told of one queue of jobs only, as an operator may start it."""
    with running(settings, log, "--concurrency", "1", "--queues", RECONSTRUCT_QUEUE) as process:
        until(lambda: workers.heartbeat_finished_ago_s() is not None, log)
        yield process


def until(is_so: Callable[[], bool], log: Path, within_s: float = 30.0) -> None:
    deadline = time.monotonic() + within_s
    while not is_so():
        assert time.monotonic() < deadline, log.read_text()
        time.sleep(0.02)


def silence_s(workers: LiveWorkers) -> float:
    ago_s = workers.heartbeat_finished_ago_s()
    assert ago_s is not None
    return ago_s


def test_a_worker_that_stands_idle_goes_on_finishing_heartbeats(
    worker: "Popen[bytes]", workers: LiveWorkers, redis: Redis
) -> None:
    longest_s = 0.0
    deadline = time.monotonic() + 3.0
    while time.monotonic() < deadline:
        longest_s = max(longest_s, silence_s(workers))
        time.sleep(0.02)
    assert longest_s < 2 * _ALIVE_S
    assert redis.llen(HEARTBEAT_QUEUE) <= 1


def test_a_worker_whose_child_hangs_is_alive_and_finishes_none(
    worker: "Popen[bytes]", workers: LiveWorkers, redis: Redis, log: Path
) -> None:
    (child,) = psutil.Process(worker.pid).children()
    child.suspend()
    until(lambda: silence_s(workers) > 2.0, log)
    assert workers.names(_ALIVE_S), "the loop that takes jobs has not stopped"
    assert redis.llen(HEARTBEAT_QUEUE) <= 1, "they do not pile up"
    child.resume()
    until(lambda: silence_s(workers) < 2 * _ALIVE_S, log)


def test_a_worker_without_its_store_finishes_none(
    worker: "Popen[bytes]", workers: LiveWorkers, settings: WorkerSettings, log: Path
) -> None:
    settings.jobs_dir.rename(settings.data_dir / "elsewhere")
    settings.data_dir.joinpath("jobs").symlink_to("nowhere")
    until(lambda: silence_s(workers) > 2.0, log)
    assert "the job store takes no file" in log.read_text()
    settings.jobs_dir.unlink()
    settings.jobs_dir.mkdir()
    until(lambda: silence_s(workers) < 2 * _ALIVE_S, log)


def test_a_redis_that_forgets_everything_is_told_again(
    worker: "Popen[bytes]", workers: LiveWorkers, redis: Redis, log: Path
) -> None:
    redis.flushall()
    until(lambda: workers.heartbeat_finished_ago_s() is not None, log)


def test_a_worker_says_how_many_jobs_it_does_at_a_time(
    workers: LiveWorkers, settings: WorkerSettings, log: Path
) -> None:
    with running(settings, log, "--concurrency", "3", "--hostname", "three@test"):
        until(lambda: workers.names(30.0) == ["three@test"], log)
        assert workers.slots(30.0) == 3
        until(lambda: workers.heartbeat_finished_ago_s() is not None, log)


def test_a_heartbeat_goes_before_the_jobs_that_wait(
    workers: LiveWorkers, settings: WorkerSettings, queue: JobQueue, log: Path
) -> None:
    # Of no folder: a worker drops each, but only once its child has loaded the science.
    for priority in Priority:
        queue.enqueue(ReconstructMessage(job_id="0" * 32, priority=priority))
    queue.ask_for_heartbeat()
    with running(settings, log, "--concurrency", "1"):
        until(lambda: workers.heartbeat_finished_ago_s() is not None, log)
        assert queue.depth() >= 1
        until(lambda: queue.depth() == 0, log)
