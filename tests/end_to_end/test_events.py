"""Following real jobs: with the command, with a script, through restarts and stops."""

import json
import re
import subprocess
import sys
import time
from collections.abc import Callable, Iterator
from pathlib import Path
from typing import Any

import httpx
import pytest

from tests.end_to_end.following import Job, follow, follow_until_fitting
from tests.end_to_end.serve_process import NEURALMRI, ServeProcess
from tests.end_to_end.test_chaos import ENDLESS, SECONDS
from tests.redis_server import RedisServer

pytestmark = [pytest.mark.integration, pytest.mark.slow]

Submit = Callable[[ServeProcess, dict[str, Any]], Job]
Start = Callable[..., ServeProcess]

API_PAGE = Path(__file__).parents[2] / "docs" / "api.md"


@pytest.fixture
def start(tmp_path: Path) -> Iterator[Start]:
    started: list[ServeProcess] = []

    def run(*options: str, port: int | None = None) -> ServeProcess:
        started.append(ServeProcess(tmp_path / "data", *options, port=port))
        return started[-1].wait_until_ready()

    yield run
    for server in started:
        if server.process.poll() is None:
            server.stop()


class Watch:
    """The command, running. It has heard the first event."""

    def __init__(self, server: ServeProcess, job_id: str, out: Path) -> None:
        self._out = out
        with out.open("wb") as file:
            self._process = subprocess.Popen(
                [NEURALMRI, "watch", job_id, "--json", "--server", server.url], stdout=file
            )
        while not out.stat().st_size:
            assert self._process.poll() is None
            time.sleep(0.05)

    def said(self) -> str:
        """What it printed until it ended, well."""
        assert self._process.wait(timeout=60) == 0, self._out.read_text()
        return self._out.read_text()


def states(lines: str) -> list[str]:
    events = [json.loads(line) for line in lines.splitlines()]
    return [event["data"]["state"] for event in events if event["event"] == "state"]


def test_a_real_job_is_told_from_beginning_to_end(server: ServeProcess, submit: Submit) -> None:
    job = submit(server, SECONDS)
    start = time.monotonic()
    with httpx.stream("GET", f"{server.url}{job['links']['events']}", timeout=60) as answer:
        text = answer.read().decode()
    took_s = time.monotonic() - start
    events = [
        (kind, json.loads(data))
        for kind, data in re.findall(r"event: (\w+)\ndata: (.*)\nid: .*\n", text)
    ]
    assert [d["state"] for kind, d in events if kind == "state"] == [
        "queued",
        "running",
        "succeeded",
    ]
    progress = [data for kind, data in events if kind == "progress"]
    stages = list(dict.fromkeys(step["stage"] for step in progress))
    assert stages == ["reading", "fitting", "meshing", "measuring", "writing", "done"]
    assert len(progress) <= 4 * took_s + 2 * len(stages)
    fractions = [step["fraction"] for step in progress]
    assert fractions == sorted(fractions)
    fitting = [step for step in progress if step["stage"] == "fitting"]
    assert any(step["loss"] is not None and step["level"] is not None for step in fitting)
    assert any(step["eta_s"] is not None for step in progress)
    ids = re.findall(r"^id: (\S+)$", text, re.MULTILINE)
    assert len(ids) == len(set(ids)) == len(events)
    end = httpx.get(f"{server.url}{job['links']['self']}").json()
    assert events[-1][1] == end


def test_a_submission_can_be_held_until_the_end(
    server: ServeProcess, study: dict[str, Any]
) -> None:
    answer = httpx.post(
        f"{server.url}/v1/jobs/contours",
        json={"study": study, "options": SECONDS},
        headers={"Prefer": "wait=60"},
        timeout=90,
    )
    assert (answer.status_code, answer.json()["state"]) == (202, "succeeded")


def test_the_script_of_the_api_page_follows_a_job(
    server: ServeProcess, submit: Submit, tmp_path: Path
) -> None:
    section = API_PAGE.read_text().split("## Following a job")[1].split("\n## ")[0]
    (script,) = re.findall(r"^```python\n(.*?)^```", section, re.MULTILINE | re.DOTALL)
    (tmp_path / "follow.py").write_text(script)
    job = submit(server, SECONDS)
    ended = subprocess.run(
        [sys.executable, tmp_path / "follow.py", f"{server.url}{job['links']['self']}"],
        capture_output=True,
        text=True,
        check=True,
        timeout=120,
    )
    lines = ended.stdout.splitlines()
    assert lines[0].startswith("state {")
    assert any(line.startswith("progress {") for line in lines)
    assert "'succeeded'" in lines[-1]


@pytest.mark.parametrize("as_json", [False, True])
def test_watch_ends_as_the_job_does(
    server: ServeProcess, submit: Submit, study: dict[str, Any], as_json: bool
) -> None:
    flags = ["--json"] if as_json else []

    def watch(job_id: str) -> "subprocess.CompletedProcess[str]":
        return subprocess.run(
            [NEURALMRI, "watch", job_id, "--server", server.url, *flags],
            capture_output=True,
            text=True,
            check=False,
            timeout=120,
        )

    done = watch(submit(server, SECONDS)["id"])
    assert done.returncode == 0, done.stderr
    if as_json:
        assert states(done.stdout) == ["queued", "running", "succeeded"]
    else:
        assert "lv_endo" in done.stdout

    job = submit(server, ENDLESS)
    httpx.post(f"{server.url}{job['links']['cancel']}")
    cancelled = watch(job["id"])
    assert cancelled.returncode == 2
    if as_json:
        assert states(cancelled.stdout)[-1] == "cancelled"
    else:
        assert "cancelled" in cancelled.stderr

    unknown = watch("0" * 32)
    assert unknown.returncode == 2
    assert "no such job" in (unknown.stdout if as_json else unknown.stderr)


def test_watch_sits_out_a_restart_of_the_server(
    start: Start, submit: Submit, tmp_path: Path
) -> None:
    server = start()
    # Long enough not to end before the server is stopped.
    job = submit(server, {**SECONDS, "levels": 6, "iterations_per_level": 200})
    follow_until_fitting(server, job["id"])
    watch = Watch(server, job["id"], tmp_path / "said")

    server.stop()
    again = start(port=server.port)
    follow(again, job["id"], "succeeded")

    said = watch.said()
    assert states(said) == ["queued", "running", "queued", "running", "succeeded"]
    ids = [json.loads(line)["id"] for line in said.splitlines()]
    assert len(ids) == len(set(ids)), "nothing is told twice"


def test_watch_sits_out_the_loss_of_redis(start: Start, submit: Submit, tmp_path: Path) -> None:
    (tmp_path / "redis").mkdir()
    redis = RedisServer(tmp_path / "redis")
    redis.start()
    try:
        server = start("--redis-url", redis.url)
        job = submit(server, SECONDS)
        follow_until_fitting(server, job["id"])
        watch = Watch(server, job["id"], tmp_path / "said")

        redis.kill()
        time.sleep(1.0)
        redis.start()
        follow(server, job["id"], "succeeded")

        said = states(watch.said())
        assert (said[0], said[-1]) == ("queued", "succeeded")
        server.stop()
    finally:
        redis.kill()


def test_open_streams_and_held_answers_do_not_delay_the_servers_stop(
    start: Start, submit: Submit
) -> None:
    server = start()
    job = submit(server, ENDLESS)
    follow_until_fitting(server, job["id"])
    api = server.child("uvicorn")
    held = subprocess.Popen(
        ["curl", "-sS", "-H", "Prefer: wait=60", f"{server.url}{job['links']['self']}"],
        stdout=subprocess.PIPE,
    )
    with httpx.stream("GET", f"{server.url}{job['links']['events']}", timeout=60) as answer:
        lines = answer.iter_lines()
        next(lines)
        time.sleep(0.5)
        begin = time.monotonic()
        api.terminate()
        for _ in lines:
            pass  # to its end, in good order
        api.wait(timeout=10)
        took_s = time.monotonic() - begin
    said, _ = held.communicate(timeout=10)
    assert took_s < 2.5, "three seconds are the server's patience"
    assert json.loads(said)["state"] == "running"
    server.end()
    log = (server.data_dir / "logs" / "api.log").read_text()
    assert "Cancel" not in log
    assert "Traceback" not in log
