import re
import time
from collections.abc import Callable

import pytest
from redis import Redis

from schemas.problem import ProblemType
from service.settings import ServiceSettings
from tests.service.conftest import Api
from tests.service.jobs_done import claim
from tests.service.test_jobs import problem_of, submitted


def test_readiness_needs_a_live_worker(api: Api) -> None:
    problem = problem_of(api.client.get("/readyz"), 503, ProblemType.UNAVAILABLE)
    assert [part.pointer for part in problem.errors] == ["workers"]
    alive(api)
    assert api.client.get("/readyz").json() == {"status": "ready", "workers": ["worker@test"]}


def test_readiness_needs_a_worker_that_does_what_it_takes(api: Api) -> None:
    api.workers.heartbeat("worker@test")
    problem = problem_of(api.client.get("/readyz"), 503, ProblemType.UNAVAILABLE)
    assert [part.pointer for part in problem.errors] == ["workers"]
    assert "none finished a heartbeat" in problem.detail
    assert value(api, "neuralmri_work_done") == 0.0

    token = claim(api.records, submitted(api))
    assert token
    assert api.client.get("/readyz").is_success, "every worker is at a job"
    assert value(api, "neuralmri_work_done") == 1.0


def test_a_heartbeat_finished_long_ago_proves_nothing(
    settings: ServiceSettings, serve: Callable[[ServiceSettings], Api], redis: Redis
) -> None:
    api = serve(settings.model_copy(update={"worker_alive_s": 0.2}))
    alive(api)
    assert api.client.get("/readyz").is_success
    time.sleep(0.5)
    api.workers.heartbeat("worker@test")
    problem_of(api.client.get("/readyz"), 503, ProblemType.UNAVAILABLE)


def alive(api: Api) -> None:
    """A worker that said so and has shown it."""
    api.workers.heartbeat("worker@test")
    api.workers.finished_heartbeat()


def test_readiness_needs_a_store(api: Api) -> None:
    alive(api)
    api.store.root.rmdir()
    problem = problem_of(api.client.get("/readyz"), 503, ProblemType.UNAVAILABLE)
    assert [part.pointer for part in problem.errors] == ["store"]
    api.store.root.mkdir()


def value(api: Api, name: str, missing: float | None = None) -> float:
    found = re.search(rf"^{re.escape(name)} (\S+)$", api.client.get("/metrics").text, re.MULTILINE)
    if missing is not None and not found:
        return missing
    assert found, name
    return float(found.group(1))


def test_metrics_count_jobs_and_requests(api: Api) -> None:
    requests = "neuralmri_http_requests_total"
    looks = f'{requests}{{method="GET",route="/v1/jobs/{{job_id}}",status="200"}}'
    misses = f'{requests}{{method="GET",route="unmatched",status="404"}}'
    looks_before, misses_before = value(api, looks, 0.0), value(api, misses, 0.0)
    ids = [submitted(api) for _ in range(3)]
    api.client.post(f"/v1/jobs/{ids[0]}/cancel")
    api.workers.heartbeat("worker@test")
    for _ in range(4):
        api.client.get(f"/v1/jobs/{ids[1]}")
    api.client.get("/nowhere")
    api.client.request("INVENTED", f"/v1/jobs/{ids[1]}")
    assert value(api, 'neuralmri_jobs{state="queued"}') == 2
    assert value(api, 'neuralmri_jobs{state="cancelled"}') == 1
    assert value(api, "neuralmri_queue_depth") == 3
    assert value(api, "neuralmri_live_workers") == 1
    assert value(api, "neuralmri_redis_up") == 1
    assert value(api, looks) == looks_before + 4
    assert value(api, misses) == misses_before + 1
    text = api.client.get("/metrics").text
    assert "INVENTED" not in text
    assert ids[1] not in text


@pytest.mark.parametrize("path", ["/healthz", "/v1/jobs", "/nowhere", "/metrics"])
def test_every_answer_carries_the_safety_headers(api: Api, path: str) -> None:
    headers = api.client.get(path).headers
    assert headers["x-content-type-options"] == "nosniff"
    assert headers["cache-control"] == "no-store"
