"""The images' own commands, run for real: they start, pass their health checks, and stop."""

import json
import os
import re
import signal
import subprocess
import sys
import sysconfig
import time
from collections.abc import Callable, Iterator
from pathlib import Path

import pytest

from tests.redis_server import RedisServer, free_port

ROOT = Path(__file__).parents[2]

pytestmark = pytest.mark.integration

Start = Callable[[list[str]], "subprocess.Popen[bytes]"]


def commands(name: str) -> tuple[list[str], list[str]]:
    """Health check and command of an image, with what differs outside of a container replaced."""
    text = re.sub(r"\\\n\s*", "", (ROOT / "docker" / f"{name}.Dockerfile").read_text())
    health, command = re.findall(r'CMD (\[".*"\])$', text, re.MULTILINE)
    health = health.replace(
        "/opt/neuralmri/worker_health.py", str(ROOT / "docker/worker_health.py")
    )
    return json.loads(health), json.loads(command)


@pytest.fixture
def redis(tmp_path: Path) -> Iterator[RedisServer]:
    server = RedisServer(tmp_path)
    server.start()
    yield server
    server.kill()


@pytest.fixture
def environment(redis: RedisServer, tmp_path: Path) -> dict[str, str]:
    return {
        "PATH": f"{sysconfig.get_path('scripts')}{os.pathsep}{os.environ['PATH']}",
        "PYTHONPATH": str(ROOT),
        "HOME": str(tmp_path),
        "OMP_NUM_THREADS": "1",
        "OPENBLAS_NUM_THREADS": "1",
        "NEURALMRI_REDIS_URL": redis.url,
        "NEURALMRI_DATA_DIR": str(tmp_path / "data"),
    }


@pytest.fixture
def start(environment: dict[str, str], tmp_path: Path) -> Iterator[Start]:
    started: list[subprocess.Popen[bytes]] = []

    def run(command: list[str]) -> "subprocess.Popen[bytes]":
        with (tmp_path / "log").open("wb") as log:
            process = subprocess.Popen(
                command,
                env=environment,
                cwd=tmp_path,
                stdin=subprocess.DEVNULL,
                stdout=log,
                stderr=log,
            )
        started.append(process)
        return process

    yield run
    for process in started:
        process.kill()
        process.wait(timeout=20)


def is_healthy(health: list[str], environment: dict[str, str]) -> bool:
    command = [sys.executable, *health[1:]]
    assert health[0] == "python"
    ended = subprocess.run(command, env=environment, capture_output=True, timeout=20, check=False)
    return ended.returncode == 0


def wait_until_healthy(
    process: "subprocess.Popen[bytes]", health: list[str], environment: dict[str, str], log: Path
) -> None:
    deadline = time.monotonic() + 60.0
    while not is_healthy(health, environment):
        assert process.poll() is None, log.read_text()
        assert time.monotonic() < deadline, log.read_text()
        time.sleep(0.2)


def test_service_starts_is_healthy_and_stops(
    start: Start, environment: dict[str, str], tmp_path: Path
) -> None:
    port = str(free_port())
    health, command = commands("service")
    health = [word.replace("8000", port) for word in health]
    command = [port if word == "8000" else word for word in command]
    command[command.index("0.0.0.0")] = "127.0.0.1"  # noqa: S104  what the image listens on
    assert not is_healthy(health, environment)
    process = start(command)
    wait_until_healthy(process, health, environment, tmp_path / "log")
    process.send_signal(signal.SIGTERM)
    assert process.wait(timeout=30) in (0, -signal.SIGTERM), (tmp_path / "log").read_text()


def test_worker_starts_is_healthy_and_stops(
    start: Start, environment: dict[str, str], redis: RedisServer, tmp_path: Path
) -> None:
    health, command = commands("worker")
    assert not is_healthy(health, environment)
    process = start(command)
    wait_until_healthy(process, health, environment, tmp_path / "log")
    process.send_signal(signal.SIGTERM)
    assert process.wait(timeout=30) == 0, (tmp_path / "log").read_text()
    redis.kill()
    assert not is_healthy(health, environment)
