"""One round of load: a stack whose workers are busy with fits, and requests on a schedule."""

import json
import os
import shutil
import subprocess
import sys
import sysconfig
import time
from collections.abc import Callable
from dataclasses import dataclass
from pathlib import Path
from typing import Any

import httpx
import psutil

from benchmarks.load_plan import LoadPlan, Samples, schedule
from benchmarks.measure import ROOT
from benchmarks.small_study import QUICK, small_request
from benchmarks.stack import Stack

ENDLESS = {"iterations_per_level": 5000, "levels": 8}
"""Options of a fit that outlasts any round."""

_POINTS = 115
"""Of each contour: a submission of 100 kB."""

_QUEUED = 10


@dataclass(frozen=True)
class LoadRound:
    """load: runnable processes, one minute's mean, at the end. api_cpu_s: of the API, all its
    threads, for all requests. rss_mib: its resident memory after it.
    """

    samples: Samples
    load: float
    api_cpu_s: float
    rss_mib: float
    body_bytes: int


def load_round(
    stack: Stack, rate_hz: float, seconds: float, seed: int, profile: Path | None = None
) -> LoadRound:
    """Keep the workers busy, send, and empty the stack again. profile: what py-spy writes."""
    body = json.dumps(small_request("load", QUICK, _POINTS))
    with httpx.Client(base_url=stack.url, timeout=60.0, trust_env=False) as client:
        ended = [_submitted(client, QUICK) for _ in stack.workers]
        _wait(client, lambda: all(_state(client, job_id) == "succeeded" for job_id in ended))
        busy = [_submitted(client, ENDLESS) for _ in stack.workers]
        _wait(client, lambda: all(_is_fitting(client, job_id) for job_id in busy))
        queued = [_submitted(client, QUICK) for _ in range(_QUEUED)]
        jobs = [*ended, *busy, *queued]
        plan = LoadPlan(url=stack.url, body=body, due=schedule(rate_hz, seconds, jobs, ended, seed))
        api = psutil.Process(stack.api.pid)
        before_s = sum(api.cpu_times()[:2])
        profiler = _profiler(stack.api.pid, seconds, profile) if profile else None
        sent = subprocess.run(
            [sys.executable, "-m", "benchmarks.open_loop"],
            cwd=ROOT,
            input=plan.model_dump_json().encode(),
            stdout=subprocess.PIPE,
            check=True,
        )
        api_cpu_s = sum(api.cpu_times()[:2]) - before_s
        if profiler is not None:
            profiler.wait()
        found = LoadRound(
            samples=Samples.model_validate_json(sent.stdout),
            load=os.getloadavg()[0],
            api_cpu_s=api_cpu_s,
            rss_mib=api.memory_info().rss / 2**20,
            body_bytes=len(body),
        )
        _erase_all(client)
    return found


def _profiler(pid: int, seconds: float, file: Path) -> "subprocess.Popen[bytes]":
    command = [
        *(_program("py-spy"), "record", "--format", "raw", "--gil", "--threads", "--rate", "200"),
        *("--duration", str(int(seconds)), "--pid", str(pid), "--output", str(file)),
    ]
    return subprocess.Popen(command)


def _program(name: str) -> str:
    """A program of this environment, on the PATH or not. Raises FileNotFoundError."""
    found = shutil.which(name, path=sysconfig.get_path("scripts")) or shutil.which(name)
    if found is None:
        raise FileNotFoundError(f"there is no {name}: pip install '.[bench]'")
    return found


def _submitted(client: httpx.Client, options: dict[str, Any]) -> str:
    answer = client.post("/v1/jobs/contours", json=small_request("load", options))
    job_id: str = answer.raise_for_status().json()["id"]
    return job_id


def _job(client: httpx.Client, job_id: str) -> dict[str, Any]:
    job: dict[str, Any] = client.get(f"/v1/jobs/{job_id}").raise_for_status().json()
    return job


def _state(client: httpx.Client, job_id: str) -> str:
    return str(_job(client, job_id)["state"])


def _is_fitting(client: httpx.Client, job_id: str) -> bool:
    return bool(_job(client, job_id)["progress"]["stage"] == "fitting")


def _wait(client: httpx.Client, is_so: Callable[[], bool], within_s: float = 180.0) -> None:
    deadline = time.monotonic() + within_s
    while not is_so():
        if time.monotonic() > deadline:
            raise TimeoutError(f"the workers did not come so far: {client.get('/metrics').text}")
        time.sleep(0.1)


def _erase_all(client: httpx.Client) -> None:
    while jobs := client.get("/v1/jobs", params={"limit": "200"}).json()["jobs"]:
        for job in jobs:
            client.delete(f"/v1/jobs/{job['id']}")
