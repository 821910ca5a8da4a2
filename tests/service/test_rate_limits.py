"""How often a caller may call, what it is told, and whom that never touches."""

from collections.abc import Callable

import pytest

from schemas.problem import ProblemType
from service.examples import CONTOUR_REQUEST
from service.settings import ServiceSettings
from tests.redis_server import RedisServer
from tests.service.callers import bearer, new_key
from tests.service.conftest import Api
from tests.service.test_jobs import problem_of
from tests.service.test_without_redis import own_redis

__all__ = ["own_redis"]

Serve = Callable[[ServiceSettings], Api]


def limited(settings: ServiceSettings, **limits: int) -> ServiceSettings:
    return settings.model_copy(update=limits)


def test_an_address_is_limited_and_told_so(settings: ServiceSettings, serve: Serve) -> None:
    api = serve(limited(settings, calls_per_minute=5, submits_per_minute=2))
    api.redis.flushall()
    for left in (1, 0):
        answer = api.client.post("/v1/jobs/contours", json=CONTOUR_REQUEST)
        assert answer.status_code == 202
        assert answer.headers["ratelimit-policy"] == '"calls";q=5;w=60, "submits";q=2;w=60'
        assert f'"submits";r={left};t=' in answer.headers["ratelimit"]
    problem_of(
        refused := api.client.post("/v1/jobs/contours", json=CONTOUR_REQUEST),
        429,
        ProblemType.RATE_LIMITED,
    )
    assert 1 <= int(refused.headers["retry-after"]) <= 60
    assert '"submits";r=0;t=' in refused.headers["ratelimit"]
    statuses = [api.client.get("/v1/jobs").status_code for _ in range(4)]
    assert statuses == [200, 200, 200, 429], "a refused submission costs no call"
    for path in ("/healthz", "/metrics", "/openapi.json"):
        answer = api.client.get(path)
        assert (answer.status_code, "ratelimit" in answer.headers) == (200, False)
    assert len(api.store.ids()) == 2


def test_zero_is_no_limit(settings: ServiceSettings, serve: Serve) -> None:
    api = serve(limited(settings, calls_per_minute=0, submits_per_minute=0))
    assert "ratelimit" not in api.client.get("/v1/jobs").headers


def test_each_key_has_its_own(settings: ServiceSettings, serve: Serve) -> None:
    one, other = (new_key(settings.data_dir, name)[1] for name in ("one", "other"))
    api = serve(limited(settings, calls_per_minute=2))
    api.redis.flushall()
    statuses = [api.client.get("/v1/jobs", headers=bearer(one)).status_code for _ in range(3)]
    assert statuses == [200, 200, 429]
    assert api.client.get("/v1/jobs", headers=bearer(other)).status_code == 200


def test_bad_keys_are_limited_and_lock_no_good_one_out(
    settings: ServiceSettings, serve: Serve
) -> None:
    _, token = new_key(settings.data_dir, "ours")
    api = serve(limited(settings, refusals_per_minute=3))
    api.redis.flushall()
    wrong = bearer(token[:-4] + "0000")
    statuses = [api.client.get("/v1/jobs", headers=wrong).status_code for _ in range(5)]
    assert statuses == [401, 401, 401, 429, 429]
    assert api.client.get("/v1/jobs", headers=bearer(token)).status_code == 200


@pytest.mark.parametrize("how", ["kill", "freeze"])
def test_without_redis_nobody_is_refused(
    settings: ServiceSettings, serve: Serve, own_redis: RedisServer, how: str
) -> None:
    api = serve(
        limited(settings, calls_per_minute=1).model_copy(update={"redis_url": own_redis.url})
    )
    getattr(own_redis, how)()
    for _ in range(3):
        assert api.client.get("/v1/options").status_code == 200
        problem_of(api.client.get("/v1/jobs"), 503, ProblemType.UNAVAILABLE)
