"""What callers see while Redis answers and takes no writes: out of memory, or made a replica."""

import time
from collections.abc import Callable, Iterator
from pathlib import Path

import pytest
from redis import Redis

from schemas.problem import ProblemType
from service.examples import CONTOUR_REQUEST
from service.settings import ServiceSettings
from tests.redis_server import RedisServer
from tests.service.conftest import Api
from tests.service.test_jobs import problem_of, submitted

REFUSALS: dict[str, tuple[Callable[[Redis], object], Callable[[Redis], object]]] = {
    "out of memory": (
        lambda redis: redis.config_set("maxmemory", "1"),
        lambda redis: redis.config_set("maxmemory", "0"),
    ),
    # Of a master that is not there: its data stay.
    "read-only": (
        lambda redis: redis.replicaof("127.0.0.1", 1),
        lambda redis: redis.replicaof("NO", "ONE"),
    ),
}


@pytest.fixture
def own_api(
    tmp_path: Path, settings: ServiceSettings, serve: Callable[[ServiceSettings], Api]
) -> Iterator[Api]:
    server = RedisServer(tmp_path)
    server.start()
    yield serve(settings.model_copy(update={"redis_url": server.url}))
    server.kill()


@pytest.mark.parametrize("how", REFUSALS)
def test_nothing_is_accepted_and_all_of_it_is_told_until_writes_are_taken_again(
    own_api: Api, how: str
) -> None:
    refuse, relent = REFUSALS[how]
    own_api.workers.heartbeat("worker-1@here")
    own_api.workers.finished_heartbeat()
    job_id = submitted(own_api)
    assert own_api.client.get("/readyz").is_success
    refuse(own_api.redis)
    start = time.monotonic()
    answers = [
        own_api.client.post("/v1/jobs/contours", json=CONTOUR_REQUEST),
        own_api.client.post(f"/v1/jobs/{job_id}/cancel"),
        own_api.client.get("/readyz"),
    ]
    assert time.monotonic() - start < 10.0
    for answer in answers:
        problem = problem_of(answer, 503, ProblemType.UNAVAILABLE)
        assert problem.fault == "service"
        assert int(answer.headers["retry-after"]) > 0
    assert [e.pointer for e in problem_of(answers[-1], 503, ProblemType.UNAVAILABLE).errors] == [
        "redis"
    ]
    assert own_api.store.ids() == [job_id]
    assert own_api.client.get(f"/v1/jobs/{job_id}").json()["state"] == "queued"
    relent(own_api.redis)
    submitted(own_api)
    assert own_api.client.get("/readyz").is_success
