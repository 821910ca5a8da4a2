"""Watching a job over HTTP."""

import time
from typing import Any, Protocol

import httpx

Job = dict[str, Any]


class Server(Protocol):
    """Whatever answers under an address."""

    @property
    def url(self) -> str: ...


def follow(server: Server, job_id: str, *states: str, within_s: float = 120.0) -> Job:
    """Poll until the job is in one of `states`; it must not end in another."""
    deadline = time.monotonic() + within_s
    while True:
        job: Job = httpx.get(f"{server.url}/v1/jobs/{job_id}", timeout=30).json()
        if job["state"] in states:
            return job
        assert job["state"] not in ("succeeded", "failed", "cancelled"), job
        assert time.monotonic() < deadline, job
        time.sleep(0.05)


def follow_until_fitting(server: Server, job_id: str) -> Job:
    """Poll until the job is in the middle of its work."""
    while True:
        job = follow(server, job_id, "running")
        if job["progress"]["stage"] == "fitting":
            return job
        time.sleep(0.05)
