"""What callers see, and how soon, while Redis is dead, frozen or empty."""

import time
from collections.abc import Callable, Iterator
from pathlib import Path

import pytest

from schemas.job import JobState
from schemas.problem import ProblemType
from service.examples import CONTOUR_REQUEST
from service.settings import ServiceSettings
from tests.redis_server import RedisServer
from tests.service.conftest import Api
from tests.service.jobs_done import MESH, finish
from tests.service.test_jobs import problem_of, submitted


@pytest.fixture
def own_redis(tmp_path: Path) -> Iterator[RedisServer]:
    server = RedisServer(tmp_path)
    server.start()
    yield server
    server.kill()


@pytest.fixture
def own_api(
    own_redis: RedisServer, settings: ServiceSettings, serve: Callable[[ServiceSettings], Api]
) -> Api:
    return serve(settings.model_copy(update={"redis_url": own_redis.url}))


@pytest.mark.parametrize("how", ["kill", "freeze"])
def test_a_submission_is_refused_soon_and_leaves_nothing(
    own_api: Api, own_redis: RedisServer, how: str
) -> None:
    submitted_before = submitted(own_api)
    getattr(own_redis, how)()
    start = time.monotonic()
    answer = own_api.client.post("/v1/jobs/contours", json=CONTOUR_REQUEST)
    assert time.monotonic() - start < 5.0
    problem = problem_of(answer, 503, ProblemType.UNAVAILABLE)
    assert problem.fault == "service"
    assert int(answer.headers["retry-after"]) > 0
    assert own_api.store.ids() == [submitted_before]
    start = time.monotonic()
    ready = own_api.client.get("/readyz")
    assert time.monotonic() - start < 5.0
    assert "redis" in [e.pointer for e in problem_of(ready, 503, ProblemType.UNAVAILABLE).errors]
    listed = own_api.client.get("/v1/jobs")
    problem_of(listed, 503, ProblemType.UNAVAILABLE)
    assert own_api.client.get("/healthz").status_code == 200
    assert "neuralmri_redis_up 0.0" in own_api.client.get("/metrics").text


def test_results_are_served_without_redis(own_api: Api, own_redis: RedisServer) -> None:
    job_id = submitted(own_api)
    finish(own_api.store, own_api.records, job_id, JobState.SUCCEEDED)
    own_redis.kill()
    answer = own_api.client.get(f"/v1/jobs/{job_id}/artifacts/ED_lv_endo.stl")
    assert answer.content == MESH


@pytest.mark.parametrize("how", ["kill", "freeze"])
def test_erasing_needs_no_redis(own_api: Api, own_redis: RedisServer, how: str) -> None:
    """A full disk stops Redis from writing; erasing is how its space is had back."""
    job_id = submitted(own_api)
    getattr(own_redis, how)()
    for _ in range(2):
        assert own_api.client.delete(f"/v1/jobs/{job_id}").status_code == 204
    assert own_api.client.get(f"/v1/jobs/{job_id}").status_code == 404
    assert list(own_api.store.root.iterdir()) == []


def test_no_accepted_job_is_lost_with_redis(
    own_api: Api,
    own_redis: RedisServer,
    serve: Callable[[ServiceSettings], Api],
) -> None:
    """Redis comes back empty, the service is started anew: all is as it was."""
    waiting, done = submitted(own_api), submitted(own_api)
    finish(own_api.store, own_api.records, done, JobState.SUCCEEDED)
    own_redis.kill()
    own_redis.start()
    again = serve(own_api.settings)
    deadline = time.monotonic() + 10.0
    while len(jobs := again.client.get("/v1/jobs").json()["jobs"]) < 2:
        assert time.monotonic() < deadline
        time.sleep(0.05)
    assert {job["id"]: job["state"] for job in jobs} == {waiting: "queued", done: "succeeded"}
    while "neuralmri_queue_depth 1.0" not in again.client.get("/metrics").text:
        assert time.monotonic() < deadline
        time.sleep(0.05)


def test_the_service_starts_without_redis(
    own_redis: RedisServer, settings: ServiceSettings, serve: Callable[[ServiceSettings], Api]
) -> None:
    own_redis.kill()
    api = serve(settings.model_copy(update={"redis_url": own_redis.url}))
    assert api.client.get("/healthz").status_code == 200
    own_redis.start()
    api.workers.heartbeat("worker@test")
    api.workers.finished_heartbeat()
    ready = api.client.get("/readyz")
    assert (ready.status_code, ready.json()["workers"]) == (200, ["worker@test"])
