"""The whole server while its parts die, freeze, forget and refuse: each job ends, and ends once."""

import json
import random
import subprocess
import time
from collections.abc import Callable, Iterator
from concurrent.futures import ThreadPoolExecutor
from pathlib import Path
from typing import Any

import httpx
import psutil
import pytest

from jobs.redis_client import make_redis
from tests.end_to_end.following import Job, follow, follow_until_fitting
from tests.end_to_end.serve_process import NEURALMRI, ServeProcess
from tests.redis_server import RedisServer

pytestmark = [pytest.mark.integration, pytest.mark.slow]

QUICK = {
    "preset": "fast",
    "levels": 1,
    "iterations_per_level": 5,
    "mesh": {"grid_mm": 3},
    "formats": ["stl"],
}
SECONDS = {**QUICK, "iterations_per_level": 100}
ENDLESS = {"iterations_per_level": 5000, "levels": 8}
Start = Callable[..., ServeProcess]
Submit = Callable[[ServeProcess, dict[str, Any]], Job]


@pytest.fixture
def redis(tmp_path: Path) -> Iterator[RedisServer]:
    """An outside Redis that forgets everything when it is killed; the server outlives it."""
    folder = tmp_path / "redis"
    folder.mkdir()
    server = RedisServer(folder)
    server.start()
    yield server
    server.kill()


@pytest.fixture
def start(tmp_path: Path, redis: RedisServer, monkeypatch: pytest.MonkeyPatch) -> Iterator[Start]:
    # More workers are killed here than a job may lose.
    monkeypatch.setenv("NEURALMRI_MAX_ATTEMPTS", "20")
    started: list[ServeProcess] = []

    def run(port: int | None = None) -> ServeProcess:
        options = ("--workers", "2", "--redis-url", redis.url)
        started.append(ServeProcess(tmp_path / "data", *options, port=port))
        return started[-1].wait_until_ready()

    yield run
    for server in started:
        if server.process.poll() is None:
            server.stop()


def computing(server: ServeProcess) -> list[psutil.Process]:
    return server.child("worker.app").children()


def outcomes(server: ServeProcess) -> dict[Path, tuple[int, int]]:
    """Which file each written outcome is, and since when."""
    found = {}
    for path in (server.data_dir / "jobs").glob("*/outcome.json"):
        stat = path.stat()
        found[path] = (stat.st_ino, stat.st_mtime_ns)
    return found


def test_whatever_dies_every_job_ends_once(
    start: Start, submit: Submit, study: dict[str, Any], redis: RedisServer
) -> None:
    draw = random.Random(5)
    server = start()
    with ThreadPoolExecutor(10) as callers:
        accepted = [job["id"] for job in callers.map(lambda _: submit(server, QUICK), range(10))]
    seen: dict[Path, tuple[int, int]] = {}

    def kill_a_child() -> None:
        draw.choice(computing(server)).kill()

    def lose_redis() -> None:
        redis.kill()
        redis.start()

    def freeze_redis() -> None:
        redis.freeze()
        time.sleep(2.5)
        redis.thaw()

    def kill_everything() -> None:
        nonlocal server
        server.process.kill()
        server.end()
        server = start(server.port)

    for strike in (kill_a_child, lose_redis, kill_a_child, freeze_redis, kill_everything):
        time.sleep(draw.uniform(0.5, 2.0))
        strike()
        now = outcomes(server)
        assert seen.items() <= now.items(), "an outcome was written twice"
        seen = now

    for job_id in accepted:
        follow(server, job_id, "succeeded")
    assert seen.items() <= outcomes(server).items()
    listed = httpx.get(f"{server.url}/v1/jobs").json()["jobs"]
    assert sorted(job["id"] for job in listed) == sorted(accepted)
    jobs = server.data_dir / "jobs"
    assert sorted(path.name for path in jobs.iterdir()) == sorted(accepted)
    for job_id in accepted:
        inside = sorted(path.name for path in (jobs / job_id).iterdir())
        assert inside == ["inputs", "outcome.json", "request.json", "results"]
    logs = "".join(path.read_text() for path in (server.data_dir / "logs").iterdir())
    told = logs + httpx.get(f"{server.url}/metrics").text
    assert study["subject_id"] not in told, "logs and metrics know no patients"


def test_a_redis_that_refuses_writes_costs_neither_worker_nor_job(
    start: Start, submit: Submit, redis: RedisServer
) -> None:
    """As one does whose disk is full: it answers, and takes nothing."""
    server = start()
    worker = server.child("worker.app")
    job = submit(server, SECONDS)
    follow_until_fitting(server, job["id"])
    with make_redis(redis.url) as client:
        client.config_set("min-replicas-to-write", 1)
        # Longer than the rest of the job takes, and than it waits to say that it has ended.
        time.sleep(6.0)
        refused = httpx.post(f"{server.url}/v1/jobs/{job['id']}/cancel", timeout=30)
        assert refused.status_code == 503
        client.config_set("min-replicas-to-write", 0)

    follow(server, job["id"], "succeeded")
    assert server.process.poll() is None
    assert server.child("worker.app") == worker


def test_a_cancelled_job_stays_so_when_its_stopped_worker_goes_on(
    start: Start, submit: Submit
) -> None:
    server = start()
    job = submit(server, ENDLESS)
    follow_until_fitting(server, job["id"])
    stopped = computing(server)
    for child in stopped:
        child.suspend()
    waiting = submit(server, ENDLESS)

    for asked in (job, job, waiting, waiting):
        assert httpx.post(f"{server.url}{asked['links']['cancel']}").is_success
    assert httpx.delete(f"{server.url}{waiting['links']['self']}").status_code == 204
    ended = follow(server, job["id"], "cancelled", within_s=20.0)
    for child in stopped:
        child.resume()

    # The worker is free, and has changed nothing.
    follow(server, submit(server, QUICK)["id"], "succeeded")
    assert httpx.get(f"{server.url}{job['links']['self']}").json() == ended
    assert httpx.get(f"{server.url}{waiting['links']['self']}").status_code == 404
    left = sorted(path.name for path in (server.data_dir / "jobs" / job["id"]).iterdir())
    assert left == ["inputs", "outcome.json", "request.json"]


def test_who_waits_for_a_job_sits_out_a_restart_of_the_server(
    start: Start, study: dict[str, Any], tmp_path: Path
) -> None:
    server = start()
    request = tmp_path / "request.json"
    request.write_text(json.dumps({"study": study, "options": SECONDS}))
    waiting = subprocess.Popen(
        [
            *(NEURALMRI, "submit", request, "--server", server.url),
            *("--wait", "--out", tmp_path / "out"),
        ],
        stdout=subprocess.PIPE,
        stderr=subprocess.PIPE,
    )
    while not (listed := httpx.get(f"{server.url}/v1/jobs").json()["jobs"]):
        assert waiting.poll() is None
        time.sleep(0.05)
    follow_until_fitting(server, listed[0]["id"])

    server.stop()
    start(server.port)

    _, said = waiting.communicate(timeout=120)
    assert waiting.returncode == 0, said.decode()
    assert (tmp_path / "out" / "report.json").is_file()
