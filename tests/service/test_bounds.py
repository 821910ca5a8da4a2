"""The queue takes so many jobs and no more, and says when to come back."""

from collections import Counter
from collections.abc import Callable
from concurrent.futures import ThreadPoolExecutor

import httpx
import pytest
from redis import Redis

from schemas.job import JobState
from schemas.problem import Problem, ProblemType
from service.examples import CONTOUR_REQUEST
from service.settings import ServiceSettings
from tests.service.conftest import Api
from tests.service.jobs_done import claim, finish
from tests.service.test_jobs import problem_of, submitted

Serve = Callable[[ServiceSettings], Api]


def refused(api: Api) -> httpx.Response:
    before = sorted(api.store.root.iterdir()), api.records.ids()
    answer = api.client.post("/v1/jobs/contours", json=CONTOUR_REQUEST)
    assert (sorted(api.store.root.iterdir()), api.records.ids()) == before
    return answer


def test_a_full_queue_refuses_and_writes_nothing(
    serve: Serve, settings: ServiceSettings, redis: Redis
) -> None:
    api = serve(settings.model_copy(update={"max_queued_jobs": 2}))
    ids = [submitted(api) for _ in range(2)]
    answer = refused(api)
    problem = problem_of(answer, 503, ProblemType.QUEUE_FULL)
    assert problem.fault == "service"
    assert "Remedy" in problem.detail
    assert answer.headers["retry-after"] == str(settings.retry_after_s), "nothing measured yet"
    claim(api.records, ids[0])
    submitted(api)
    problem_of(refused(api), 503, ProblemType.QUEUE_FULL)


def test_a_caller_with_too_many_unfinished_jobs_is_told_so(
    serve: Serve, settings: ServiceSettings, redis: Redis
) -> None:
    api = serve(settings.model_copy(update={"max_jobs_per_owner": 2}))
    first, _ = submitted(api), submitted(api)
    claim(api.records, first)
    answer = refused(api)
    problem = problem_of(answer, 429, ProblemType.TOO_MANY_JOBS)
    assert problem.fault == "caller"
    assert int(answer.headers["retry-after"]) >= 1
    api.client.delete(f"/v1/jobs/{first}")
    submitted(api)


@pytest.mark.integration
def test_many_at_once_never_exceed_the_bound(
    serve: Serve, settings: ServiceSettings, redis: Redis
) -> None:
    bound = 9
    api = serve(settings.model_copy(update={"max_queued_jobs": bound}))

    def send(_: int) -> httpx.Response:
        with httpx.Client(base_url=str(api.client.base_url), timeout=30.0) as client:
            return client.post("/v1/jobs/contours", json=CONTOUR_REQUEST)

    with ThreadPoolExecutor(12) as pool:
        answers = list(pool.map(send, range(40)))
    assert Counter(answer.status_code for answer in answers) == {202: bound, 503: 40 - bound}
    types = {Problem.model_validate(a.json()).type for a in answers if a.status_code == 503}
    assert types == {ProblemType.QUEUE_FULL.uri}
    accepted = sorted(a.json()["id"] for a in answers if a.status_code == 202)
    assert accepted == api.store.ids() == api.records.ids()
    assert sorted(
        api.client.get(f"/v1/jobs/{job_id}").json()["queue_position"] for job_id in accepted
    ) == list(range(bound))


def test_retry_after_is_computed_from_runtimes_and_workers(
    serve: Serve, settings: ServiceSettings, redis: Redis
) -> None:
    api = serve(settings.model_copy(update={"max_queued_jobs": 3}))
    api.workers.heartbeat("worker@test", slots=2)
    running = [submitted(api) for _ in range(2)]
    for job_id in running:
        claim(api.records, job_id)
    work = api.store.folder(running[0]).request().work
    redis.rpush("neuralmri:seconds-per-work", 100.0 / work, 140.0 / work)
    told = []
    for place in range(3):
        answer = api.client.post("/v1/jobs/contours", json=CONTOUR_REQUEST)
        job = answer.json()
        assert (job["queue_position"], job["estimated_start_s"]) == (place, 60.0 * (place + 1))
        told.append(int(answer.headers["retry-after"]))
    assert told == [60, 120, 180]
    answer = refused(api)
    problem_of(answer, 503, ProblemType.QUEUE_FULL)
    assert answer.headers["retry-after"] == "60", "when the next place is free"
    redis.delete("neuralmri:seconds-per-work")
    redis.rpush("neuralmri:seconds-per-work", 100_000.0 / work)
    assert refused(api).headers["retry-after"] == "3600"


def test_places_are_in_every_view_of_a_job_that_waits(api: Api) -> None:
    ids = [submitted(api) for _ in range(3)]
    listed = api.client.get("/v1/jobs").json()["jobs"]
    assert [job["queue_position"] for job in listed] == [2, 1, 0]
    finish(api.store, api.records, ids[0], JobState.SUCCEEDED)
    assert api.client.get(f"/v1/jobs/{ids[0]}").json()["queue_position"] is None
    assert api.client.get(f"/v1/jobs/{ids[2]}").json()["queue_position"] == 1
    cancelled = api.client.post(f"/v1/jobs/{ids[1]}/cancel").json()
    assert cancelled["queue_position"] is None
    assert api.client.get(f"/v1/jobs/{ids[2]}").json()["queue_position"] == 0
