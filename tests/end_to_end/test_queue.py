"""Order, repetition and estimates with the real service and the real worker."""

from collections.abc import Callable
from typing import Any

import httpx
import pytest

from tests.end_to_end.following import Job, follow, follow_until_fitting
from tests.end_to_end.serve_process import ServeProcess

pytestmark = [pytest.mark.integration, pytest.mark.slow]

ENDLESS = {"iterations_per_level": 5000, "levels": 8}
SHORT = {"preset": "fast", "iterations_per_level": 20, "formats": ["stl"]}


def send(
    server: ServeProcess, study: dict[str, Any], priority: str = "interactive", key: str = ""
) -> httpx.Response:
    answer = httpx.post(
        f"{server.url}/v1/jobs/contours",
        params={"priority": priority},
        json={"study": study, "options": SHORT},
        headers={"Idempotency-Key": key} if key else {},
        timeout=30,
    )
    assert answer.status_code == 202, answer.text
    return answer


def test_a_worker_takes_interactive_jobs_first_and_the_line_says_so(
    server: ServeProcess, study: dict[str, Any], submit: Callable[..., Job]
) -> None:
    blocking = submit(server, ENDLESS)
    follow_until_fitting(server, blocking["id"])
    batch: list[Job] = [send(server, study, "batch").json() for _ in range(2)]
    interactive: list[Job] = [send(server, study).json() for _ in range(2)]
    line = [*interactive, *batch]
    seen = [httpx.get(f"{server.url}/v1/jobs/{job['id']}").json() for job in line]
    assert [job["queue_position"] for job in seen] == [0, 1, 2, 3]

    httpx.post(f"{server.url}{blocking['links']['cancel']}")
    ended = [follow(server, job["id"], "succeeded") for job in line]

    starts = [job["started_at"] for job in ended]
    assert starts == sorted(starts)
    assert all(job["queue_position"] is job["estimated_start_s"] is None for job in ended)


def test_estimates_come_once_a_job_was_done(server: ServeProcess, study: dict[str, Any]) -> None:
    follow(server, send(server, study).json()["id"], "succeeded")
    running = send(server, study).json()
    follow_until_fitting(server, running["id"])
    waiting = send(server, study)
    job = waiting.json()
    assert job["estimated_start_s"] > 0.0
    assert int(waiting.headers["retry-after"]) >= job["estimated_start_s"]
    follow(server, job["id"], "succeeded")


def test_a_key_finds_its_job_while_it_runs_and_when_it_is_done(
    server: ServeProcess, study: dict[str, Any]
) -> None:
    first = send(server, study, key="one and the same").json()
    follow_until_fitting(server, first["id"])
    again = send(server, study, key="one and the same")
    assert (again.json()["id"], again.headers["idempotency-replayed"]) == (first["id"], "true")
    follow(server, first["id"], "succeeded")
    assert send(server, study, key="one and the same").json()["state"] == "succeeded"
