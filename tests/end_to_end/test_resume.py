"""A worker dies, or closes, in the middle of a fit: the next one goes on after the last level."""

import json
from collections.abc import Callable, Iterator
from pathlib import Path
from typing import Any

import httpx
import pytest

from cli.same_results import compare
from tests.end_to_end.following import Job, follow
from tests.end_to_end.serve_process import ServeProcess

pytestmark = [pytest.mark.integration, pytest.mark.slow]

# Levels long enough to die in, on a machine that is busy or not.
OPTIONS = {
    "preset": "fast",
    "levels": 3,
    "iterations_per_level": 150,
    "mesh": {"grid_mm": 3},
    "formats": ["stl"],
}
Submit = Callable[[ServeProcess, dict[str, Any]], Job]


@pytest.fixture
def start(tmp_path: Path) -> Iterator[Callable[[], ServeProcess]]:
    started: list[ServeProcess] = []

    def run() -> ServeProcess:
        started.append(ServeProcess(tmp_path / "data").wait_until_ready())
        return started[-1]

    yield run
    for server in started:
        if server.process.poll() is None:
            server.stop()


def follow_into_level(server: ServeProcess, job_id: str, level: int) -> None:
    while (follow(server, job_id, "running", "queued")["progress"]["level"] or 0) < level:
        pass


def progress_of(server: ServeProcess, job_id: str) -> list[dict[str, Any]]:
    """Every progress that was told."""
    text = httpx.get(f"{server.url}/v1/jobs/{job_id}/events", timeout=30).text
    data = [json.loads(line[5:]) for line in text.splitlines() if line.startswith("data:")]
    return [told for told in data if "fraction" in told]


@pytest.mark.parametrize("end", ["killed", "closed"])
def test_an_interrupted_job_goes_on_and_gives_the_same_surfaces(
    start: Callable[[], ServeProcess], submit: Submit, end: str
) -> None:
    server = start()
    job_id, unbroken_id = (submit(server, OPTIONS)["id"] for _ in range(2))
    follow_into_level(server, job_id, 2)
    job_folder = server.data_dir / "jobs" / job_id
    assert [path.name for path in (job_folder / "checkpoints").iterdir()] == ["frame-ED-fit"]
    if end == "killed":
        server.worker_child().kill()
    else:
        server.stop()
        server = start()

    done = follow(server, job_id, "succeeded", within_s=240.0)
    follow(server, unbroken_id, "succeeded", within_s=240.0)

    assert done["attempt"] == (2 if end == "killed" else 1)
    told = progress_of(server, job_id)
    taken_up = [
        place
        for place, progress in enumerate(told)
        if progress["level"] is not None and progress["iteration"] is None
    ]
    assert len(taken_up) == 1
    assert told[taken_up[0]]["level"] == 1
    after = told[taken_up[0] :]
    assert {progress["level"] for progress in after} == {1, 2, None}
    assert min(progress["fraction"] for progress in after) > 0.5
    logs = "".join(path.read_text() for path in (server.data_dir / "logs").iterdir())
    assert "checkpoint frame-ED-fit is taken up" in logs

    results = [server.data_dir / "jobs" / name / "results" for name in (unbroken_id, job_id)]
    surfaces = sorted(path.name for path in results[0].glob("*.stl"))
    assert len(surfaces) == 3
    for name in surfaces:
        assert compare(name, *results).verdict.is_same
    inside = sorted(path.name for path in job_folder.iterdir())
    assert inside == ["inputs", "outcome.json", "request.json", "results"]
