"""A running server that tests share, a phantom study, and requests made of it."""

import json
import subprocess
from collections.abc import Callable, Iterator
from pathlib import Path
from typing import Any

import httpx
import pytest

from tests.end_to_end.following import Job
from tests.end_to_end.serve_process import NEURALMRI, ServeProcess


@pytest.fixture(scope="session")
def server(tmp_path_factory: pytest.TempPathFactory) -> Iterator[ServeProcess]:
    process = ServeProcess(tmp_path_factory.mktemp("data")).wait_until_ready()
    yield process
    process.stop()


@pytest.fixture(scope="session")
def study(tmp_path_factory: pytest.TempPathFactory) -> dict[str, Any]:
    """One frame of the phantom, as the command line makes it."""
    folder = tmp_path_factory.mktemp("phantom")
    subprocess.run([NEURALMRI, "phantom", "--out", folder], check=True, capture_output=True)
    document: dict[str, Any] = json.loads((folder / "study.json").read_text())
    document["frames"] = document["frames"][:1]
    return document


@pytest.fixture
def study_file(study: dict[str, Any], tmp_path: Path) -> Path:
    path = tmp_path / "study.json"
    path.write_text(json.dumps(study))
    return path


@pytest.fixture
def submit(study: dict[str, Any]) -> Callable[[ServeProcess, dict[str, Any]], Job]:
    def send(server: ServeProcess, options: dict[str, Any]) -> Job:
        body = {"study": study, "options": options}
        answer = httpx.post(f"{server.url}/v1/jobs/contours", json=body, timeout=30)
        assert answer.status_code == 202, answer.text
        job: Job = answer.json()
        return job

    return send
