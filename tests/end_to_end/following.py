"""Watching a job over HTTP."""

import time
from typing import Any

import httpx

from tests.end_to_end.serve_process import ServeProcess

Job = dict[str, Any]


def follow(server: ServeProcess, job_id: str, *states: str, within_s: float = 120.0) -> Job:
    """Poll until the job is in one of `states`; it must not end in another."""
    deadline = time.monotonic() + within_s
    while True:
        job: Job = httpx.get(f"{server.url}/v1/jobs/{job_id}", timeout=30).json()
        if job["state"] in states:
            return job
        assert job["state"] not in ("succeeded", "failed", "cancelled"), job
        assert time.monotonic() < deadline, job
        time.sleep(0.05)


def follow_until_fitting(server: ServeProcess, job_id: str) -> Job:
    """Poll until the job is in the middle of its work."""
    while True:
        job = follow(server, job_id, "running")
        if job["progress"]["stage"] == "fitting":
            return job
        time.sleep(0.05)
