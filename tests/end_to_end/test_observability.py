"""Real jobs, and all that the system says about them: enough to follow, nothing of a subject."""

import json
import time
from collections.abc import Iterator
from pathlib import Path
from typing import Any

import httpx
import pytest

from cli.truth import write_phantom_maps
from jobs.redis_client import make_redis
from schemas.labels import LabelScheme
from tests.end_to_end.following import follow, follow_until_fitting
from tests.end_to_end.serve_process import ServeProcess
from tests.redis_server import RedisServer

pytestmark = [pytest.mark.integration, pytest.mark.slow]

SUBJECT = "Roe-Jane-1961"
FILE_NAME = "Roe^Jane.nii.gz"
TRACE = "4bf92f3577b34da6a3ce929d0e0e4736"
QUICK = {"preset": "fast", "levels": 1, "iterations_per_level": 5, "mesh": {"grid_mm": 3}}


@pytest.fixture
def redis(tmp_path: Path) -> Iterator[RedisServer]:
    folder = tmp_path / "redis"
    folder.mkdir()
    server = RedisServer(folder)
    server.start()
    yield server
    server.kill()


@pytest.fixture
def server(
    tmp_path: Path, redis: RedisServer, monkeypatch: pytest.MonkeyPatch
) -> Iterator[ServeProcess]:
    monkeypatch.setenv("NEURALMRI_LOG_FORMAT", "json")
    monkeypatch.setenv("NEURALMRI_WORKER_ALIVE_S", "1")
    monkeypatch.setenv("NEURALMRI_HEARTBEAT_EVERY_S", "0.2")
    process = ServeProcess(tmp_path / "data", "--redis-url", redis.url).wait_until_ready()
    yield process
    if process.process.poll() is None:
        process.stop()


def lines(server: ServeProcess, name: str) -> list[dict[str, Any]]:
    """The log of one process, which must be JSON throughout."""
    written = (server.data_dir / "logs" / f"{name}.log").read_text().splitlines()
    # A last word of Celery's, on standard output, which `serve` keeps in the same file.
    return [json.loads(line) for line in written if line and not line.startswith("worker: ")]


def everything_in(redis: RedisServer) -> dict[str, str]:
    """All keys, with their values in words."""
    read = {"string": "get", "hash": "hgetall", "set": "smembers"}
    found = {}
    with make_redis(redis.url) as client:
        for key in client.keys("*"):
            kind = client.type(key)
            if kind == "zset":
                value = client.zrange(key, 0, -1)
            elif kind == "list":
                value = client.lrange(key, 0, -1)
            elif kind == "stream":
                value = client.xrange(key)
            else:
                value = getattr(client, read[kind])(key)
            found[key] = str(value)
    return found


def test_a_job_can_be_followed_and_its_subject_cannot(
    server: ServeProcess, redis: RedisServer, study: dict[str, Any], tmp_path: Path
) -> None:
    first_point = str(study["frames"][0]["slices"][0]["contours"][0]["points"][0][0])
    traced = {"traceparent": f"00-{TRACE}-00f067aa0ba902b7-01"}
    request = {"study": {**study, "subject_id": SUBJECT}, "options": QUICK}
    job = httpx.post(
        f"{server.url}/v1/jobs/contours?subject={SUBJECT}", json=request, headers=traced, timeout=30
    ).json()
    maps = write_phantom_maps(tmp_path, LabelScheme.ACDC)
    fast = {"preset": "fast"}
    labels = {"subject_id": SUBJECT, "label_scheme": "acdc", "options": fast}
    labelled = httpx.post(
        f"{server.url}/v1/jobs/labels",
        data={"request": json.dumps(labels)},
        files={view.value: (FILE_NAME, path.read_bytes()) for view, path in maps.items()},
        timeout=30,
    ).json()
    # What is refused, what fails in the worker, and what does not exist.
    broken = {**request, "study": {**request["study"], "units": SUBJECT}}
    refused = httpx.post(f"{server.url}/v1/jobs/contours", json=broken, headers=traced).json()
    wrong = {**labels, "label_scheme": "mnms"}
    failing = httpx.post(
        f"{server.url}/v1/jobs/labels",
        data={"request": json.dumps(wrong)},
        files={view.value: (FILE_NAME, path.read_bytes()) for view, path in maps.items()},
        timeout=30,
    ).json()
    httpx.get(f"{server.url}/v1/jobs/{SUBJECT}")
    for accepted in (job, labelled):
        follow(server, accepted["id"], "succeeded")
    failed = follow(server, failing["id"], "failed")
    assert failed["error"]["trace_id"] == failing["trace_id"]

    metrics = httpx.get(f"{server.url}/metrics").text
    in_redis = everything_in(redis)
    code, said = server.stop()
    assert code == 0, said
    logs = {path.name: path.read_text() for path in (server.data_dir / "logs").iterdir()}

    for telling in (SUBJECT, "Roe", "Jane", FILE_NAME, first_point):
        for name, text in {**logs, **in_redis, "metrics": metrics, "said": said}.items():
            assert telling not in text, name

    assert job["trace_id"] == refused["trace_id"] == TRACE
    begun = {"logger": "neuralmri.access", "route": "/v1/jobs/contours", "status": 202}
    done = {"logger": "worker.attempt", "message": f"job {job['id']} ended: succeeded"}
    about = {"job_id": job["id"], "trace_id": TRACE}
    for name, told in (("api", begun), ("worker", done)):
        assert [line for line in lines(server, name) if (told | about).items() <= line.items()]
    attempts = [line for line in lines(server, "worker") if line["logger"] == "worker.attempt"]
    ends = [line for line in attempts if " ended: " in line["message"]]
    assert {(line["job_id"], line["attempt"], line["stage"]) for line in ends} >= {
        (job["id"], 1, "done"),
        (labelled["id"], 1, "done"),
        (failing["id"], 1, "reading"),
    }
    assert all({"time", "level", "logger", "message"} <= set(line) for line in ends)

    for stage in ("waiting", "reading", "fitting", "meshing", "measuring", "writing"):
        assert f'neuralmri_stage_duration_seconds_count{{stage="{stage}"}}' in metrics, stage
    assert 'neuralmri_jobs_ended_total{fault="caller",kind="labels",state="failed"} 1.0' in metrics


def test_readiness_follows_the_child_that_computes(
    server: ServeProcess, study: dict[str, Any]
) -> None:
    def ready_is(expected: bool, within_s: float = 20.0) -> httpx.Response:
        deadline = time.monotonic() + within_s
        while True:
            answer = httpx.get(f"{server.url}/readyz")
            if answer.is_success is expected:
                return answer
            assert time.monotonic() < deadline, answer.text
            time.sleep(0.1)

    endless = {"study": study, "options": {"iterations_per_level": 5000, "levels": 8}}
    job = httpx.post(f"{server.url}/v1/jobs/contours", json=endless, timeout=30).json()
    follow_until_fitting(server, job["id"])
    deadline = time.monotonic() + 4.0
    while time.monotonic() < deadline:
        assert httpx.get(f"{server.url}/readyz").is_success, "at work is not out of order"
        time.sleep(0.2)
    httpx.post(f"{server.url}{job['links']['cancel']}")
    follow(server, job["id"], "cancelled")

    server.worker_child().suspend()
    answer = ready_is(False)
    assert "none finished a heartbeat" in answer.text
    server.worker_child().resume()
    ready_is(True)
