"""The server's own life: it starts whole, and ends whole, whoever ends it."""

import signal
import socket
from collections.abc import Callable, Iterator
from pathlib import Path
from typing import Any

import httpx
import pytest

from tests.end_to_end.following import Job, follow, follow_until_fitting
from tests.end_to_end.serve_process import ServeProcess, gone

pytestmark = [pytest.mark.integration, pytest.mark.slow]

SECONDS = {"preset": "fast", "formats": ["stl"], "iterations_per_level": 150}
"""Options of a job that fits for some seconds: long enough to be interrupted."""

Start = Callable[..., ServeProcess]
Submit = Callable[[ServeProcess, dict[str, Any]], Job]


@pytest.fixture
def start(tmp_path: Path) -> Iterator[Start]:
    started: list[ServeProcess] = []

    def run(*options: str, port: int | None = None) -> ServeProcess:
        started.append(ServeProcess(tmp_path / "data", *options, port=port))
        return started[-1]

    yield run
    for server in started:
        if server.process.poll() is None:
            server.stop()


def test_sigterm_hands_the_job_back_stops_every_process_and_a_new_server_does_the_job(
    start: Start, submit: Submit
) -> None:
    server = start().wait_until_ready()
    job = submit(server, SECONDS)
    follow_until_fitting(server, job["id"])
    family = server.family()
    assert len(family) >= 4, "Redis, API, worker and its child"

    code, error = server.stop()

    assert code == 0, error
    assert gone(family, within_s=1.0) == []

    again = start().wait_until_ready()
    done = follow(again, job["id"], "succeeded")
    assert done["attempt"] == 1, "a worker that closes in order costs no attempt"


def test_no_answer_tells_what_software_made_it(server: ServeProcess) -> None:
    for path in ("/readyz", "/nowhere", "/docs"):
        headers = httpx.get(f"{server.url}{path}").headers
        assert "server" not in headers
        assert "x-powered-by" not in headers


def test_ctrl_c_is_the_ordinary_end(start: Start) -> None:
    server = start().wait_until_ready()
    family = server.family()
    server.process.send_signal(signal.SIGINT)
    code, error = server.end()
    assert code == 0, error
    assert gone(family, within_s=1.0) == []


def test_no_process_outlives_a_server_that_was_killed(start: Start, submit: Submit) -> None:
    server = start().wait_until_ready()
    job = submit(server, SECONDS)
    follow_until_fitting(server, job["id"])
    family = server.family()

    server.process.kill()
    server.end()
    assert gone(family, within_s=5.0) == []

    again = start().wait_until_ready()
    assert follow(again, job["id"], "succeeded")["attempt"] == 2


@pytest.mark.parametrize("name", ["uvicorn", "worker.app", "redis-server"])
def test_the_whole_stops_with_an_error_when_a_part_dies(start: Start, name: str) -> None:
    server = start().wait_until_ready()
    family = server.family()

    server.child(name).kill()
    code, error = server.end()

    assert code == 1
    assert "ended by itself" in error
    assert gone(family, within_s=1.0) == []


def test_a_taken_port_is_refused_with_a_remedy(start: Start) -> None:
    with socket.socket() as taken:
        taken.bind(("127.0.0.1", 0))
        taken.listen()
        code, error = start(port=taken.getsockname()[1]).end()
    assert code == 2
    assert "--port" in error


def test_two_servers_cannot_share_a_data_folder(start: Start) -> None:
    first = start().wait_until_ready()
    code, error = start().end()
    assert code == 2
    assert "--data-dir" in error
    assert httpx.get(f"{first.url}/readyz").is_success
