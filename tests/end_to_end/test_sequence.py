"""A job of several frames loses a worker half-way: no frame that was finished is fitted again."""

import time
from collections.abc import Callable, Iterator
from contextlib import suppress
from pathlib import Path
from typing import Any

import httpx
import numpy as np
import psutil
import pytest

from cli.same_results import compare
from tests.end_to_end.following import follow
from tests.end_to_end.serve_process import ServeProcess

pytestmark = [pytest.mark.integration, pytest.mark.slow]

OPTIONS = {
    "preset": "fast",
    "levels": 2,
    "iterations_per_level": 100,
    "mesh": {"grid_mm": 4},
    "formats": ["stl"],
}
LABELS = ["F0", "F1", "F2", "F3"]


@pytest.fixture
def start(tmp_path: Path) -> Iterator[Callable[..., ServeProcess]]:
    started: list[ServeProcess] = []

    def run(processes: int = 1) -> ServeProcess:
        server = ServeProcess(tmp_path / "data", processes=processes)
        started.append(server.wait_until_ready())
        return started[-1]

    yield run
    for server in started:
        if server.process.poll() is None:
            server.stop()


@pytest.fixture
def sequence(study: dict[str, Any]) -> dict[str, Any]:
    """The phantom's frame, shrinking a little from frame to frame about its middle, on the same
    planes.
    """
    (first,) = study["frames"]
    frames = []
    for step, label in enumerate(LABELS):
        slices = []
        for one in first["slices"]:
            points = [np.array(contour["points"]) for contour in one["contours"]]
            middle = np.concatenate(points).mean(axis=0) if points else np.zeros(3)
            contours = [
                {**contour, "points": (middle + (1.0 - 0.02 * step) * (p - middle)).tolist()}
                for contour, p in zip(one["contours"], points, strict=True)
            ]
            slices.append({**one, "contours": contours})
        frames.append({**first, "label": label, "time_ms": 40.0 * step, "slices": slices})
    return {**study, "frames": frames}


def test_a_sequence_goes_on_from_the_frames_that_were_finished(
    start: Callable[..., ServeProcess], sequence: dict[str, Any]
) -> None:
    server = start()
    body = {"study": sequence, "options": OPTIONS}
    job_id, unbroken_id = (
        httpx.post(f"{server.url}/v1/jobs/contours", json=body, timeout=30).json()["id"]
        for _ in range(2)
    )
    job_folder = server.data_dir / "jobs" / job_id
    # Forward from F0 to F2, then backward to F3.
    while follow(server, job_id, "running", "queued")["progress"]["frame"] != "F2":
        time.sleep(0.1)
    kept = {path.name for path in (job_folder / "checkpoints").iterdir()}
    finished = ["frame-F0-fit", "frame-F1-fit"]
    assert kept >= set(finished)
    server.worker_child().kill()

    done = follow(server, job_id, "succeeded", within_s=240.0)
    follow(server, unbroken_id, "succeeded", within_s=240.0)

    assert done["attempt"] == 2
    logs = "".join(path.read_text() for path in (server.data_dir / "logs").iterdir())
    for name in finished:
        assert f"checkpoint {name} is taken up" in logs
    results = [server.data_dir / "jobs" / name / "results" for name in (unbroken_id, job_id)]
    surfaces = sorted(path.name for path in results[0].glob("*.stl"))
    assert len(surfaces) == 3 * len(LABELS)
    for name in surfaces:
        assert compare(name, *results).verdict.is_same


def test_two_processes_share_the_frames_and_end_with_the_job(
    start: Callable[..., ServeProcess], sequence: dict[str, Any]
) -> None:
    server = start(processes=2)
    body = {"study": sequence, "options": OPTIONS}
    job_id, cancelled_id = (
        httpx.post(f"{server.url}/v1/jobs/contours", json=body, timeout=30).json()["id"]
        for _ in range(2)
    )
    first = helper_at_work(server)
    follow(server, job_id, "succeeded", within_s=240.0)
    wait_until_gone(first)

    follow(server, cancelled_id, "running")
    second = helper_at_work(server)
    httpx.post(f"{server.url}/v1/jobs/{cancelled_id}/cancel", timeout=30)
    follow(server, cancelled_id, "cancelled")
    wait_until_gone(second)


@pytest.mark.parametrize("processes", [1, 2])
def test_a_job_that_is_cancelled_keeps_its_finished_frames_where_that_is_asked_for(
    start: Callable[..., ServeProcess], sequence: dict[str, Any], processes: int
) -> None:
    server = start(processes=processes)
    many = [
        {**frame, "label": f"{frame['label']}{turn}", "time_ms": frame["time_ms"] + 160.0 * turn}
        for turn in range(3)
        for frame in sequence["frames"]
    ]
    body = {"study": {**sequence, "frames": many}, "options": OPTIONS}
    job_id = httpx.post(f"{server.url}/v1/jobs/contours", json=body, timeout=30).json()["id"]
    checkpoints = server.data_dir / "jobs" / job_id / "checkpoints"
    while follow(server, job_id, "running", "queued") and len(list(checkpoints.glob("*"))) < 4:
        time.sleep(0.1)
    address = f"{server.url}/v1/jobs/{job_id}"
    answer = httpx.post(f"{address}/cancel?keep_frames=true", timeout=30)
    assert answer.json()["state"] == "cancelling"
    follow(server, job_id, "succeeded")
    report = httpx.get(f"{address}/artifacts/report.json", timeout=30).json()
    kept = {frame["label"] for frame in report["frames"]}
    assert 1 < len(kept) < len(many)
    assert {one["label"] for one in report["failed_frames"]} == {f["label"] for f in many} - kept
    surfaces = {path.name for path in (server.data_dir / "jobs" / job_id / "results").glob("*.stl")}
    assert surfaces == {
        f"{label}_{surface}.stl" for label in kept for surface in ("lv_endo", "lv_epi", "rv_endo")
    }


def helper_at_work(server: ServeProcess) -> psutil.Process:
    deadline = time.monotonic() + 60.0
    while time.monotonic() < deadline:
        for one in server.worker_child().children():
            # It may have ended in between.
            with suppress(psutil.NoSuchProcess):
                if "worker.helper_main" in one.cmdline():
                    return one
        time.sleep(0.02)
    raise AssertionError("no helper was started")


def wait_until_gone(process: psutil.Process) -> None:
    deadline = time.monotonic() + 10.0
    while process.is_running():
        assert time.monotonic() < deadline
        time.sleep(0.05)
