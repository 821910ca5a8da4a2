"""`Prefer: wait=N`: the answer comes with the job's end, or once the time is up."""

import socket
import threading
import time
from collections.abc import Callable
from concurrent.futures import ThreadPoolExecutor

import httpx
import pytest

from schemas.job import JobState
from schemas.problem import ProblemType
from service.examples import CONTOUR_REQUEST
from service.settings import ServiceSettings
from tests.redis_server import RedisServer
from tests.service.conftest import Api
from tests.service.jobs_done import claim, finish
from tests.service.test_events import own_api, own_redis, wait_until
from tests.service.test_jobs import problem_of, submitted

__all__ = ["own_api", "own_redis"]


def asked(api: Api, job_id: str, wait_s: int) -> tuple[httpx.Response, float]:
    start = time.monotonic()
    answer = api.client.get(f"/v1/jobs/{job_id}", headers={"Prefer": f"wait={wait_s}"})
    return answer, time.monotonic() - start


def end_soon(api: Api, job_id: str, state: JobState, after_s: float = 0.5) -> None:
    threading.Timer(after_s, finish, [api.store, api.records, job_id, state]).start()


@pytest.mark.parametrize("state", [JobState.SUCCEEDED, JobState.FAILED])
def test_the_answer_comes_with_the_end(api: Api, state: JobState) -> None:
    job_id = submitted(api)
    end_soon(api, job_id, state)
    answer, took_s = asked(api, job_id, 30)
    assert 0.4 < took_s < 5.0
    assert answer.status_code == 200
    assert answer.headers["preference-applied"] == "wait=30"
    assert "retry-after" not in answer.headers
    assert answer.json()["state"] == state
    assert answer.json() == api.client.get(f"/v1/jobs/{job_id}").json()


def test_when_the_time_is_up_the_job_is_told_as_it_is(api: Api) -> None:
    job_id = submitted(api)
    claim(api.records, job_id)
    answer, took_s = asked(api, job_id, 1)
    assert 0.9 < took_s < 3.0
    assert answer.status_code == 200
    assert answer.json()["state"] == "running"
    assert answer.headers["preference-applied"] == "wait=1"
    assert "retry-after" in answer.headers


def test_a_job_that_has_ended_is_told_at_once(api: Api) -> None:
    job_id = submitted(api)
    finish(api.store, api.records, job_id, JobState.SUCCEEDED)
    answer, took_s = asked(api, job_id, 30)
    assert took_s < 1.0
    assert answer.headers["preference-applied"] == "wait=30"


def test_a_submission_is_held_too(api: Api) -> None:
    def end_it() -> None:
        wait_until(lambda: bool(api.records.ids()))
        finish(api.store, api.records, api.records.ids()[0], JobState.SUCCEEDED)

    with ThreadPoolExecutor(1) as other:
        ending = other.submit(end_it)
        answer = api.client.post(
            "/v1/jobs/contours", json=CONTOUR_REQUEST, headers={"Prefer": "respond-async, wait=20"}
        )
        ending.result()
    assert answer.status_code == 202
    job = answer.json()
    assert job["state"] == "succeeded"
    assert answer.headers["location"] == job["links"]["self"]
    assert answer.headers["preference-applied"] == "wait=20"
    assert "retry-after" not in answer.headers


def test_no_more_is_granted_than_the_service_allows(
    settings: ServiceSettings, serve: Callable[[ServiceSettings], Api]
) -> None:
    api = serve(settings.model_copy(update={"max_wait_s": 1}))
    answer, took_s = asked(api, submitted(api), 600)
    assert took_s < 3.0
    assert answer.headers["preference-applied"] == "wait=1"


@pytest.mark.parametrize("prefer", ["wait=soon", "respond-async", ""])
def test_other_preferences_are_ignored(api: Api, prefer: str) -> None:
    answer = api.client.get(f"/v1/jobs/{submitted(api)}", headers={"Prefer": prefer})
    assert answer.status_code == 200
    assert "preference-applied" not in answer.headers


def test_refusals_are_not_held(api: Api) -> None:
    headers = {"Prefer": "wait=30"}
    start = time.monotonic()
    refused = api.client.post("/v1/jobs/contours", json={}, headers=headers)
    problem_of(refused, 422, ProblemType.INVALID_REQUEST)
    unknown = api.client.get(f"/v1/jobs/{'0' * 32}", headers=headers)
    problem_of(unknown, 404, ProblemType.NOT_FOUND)
    assert time.monotonic() - start < 2.0


def test_a_job_that_is_erased_meanwhile_is_gone(api: Api) -> None:
    job_id = submitted(api)
    threading.Timer(0.5, api.store.folder(job_id).erase).start()
    threading.Timer(0.6, api.records.forget, [job_id]).start()
    answer, took_s = asked(api, job_id, 30)
    problem_of(answer, 404, ProblemType.NOT_FOUND)
    assert took_s < 5.0


def test_more_wait_than_there_are_threads_and_others_are_served(own_api: Api) -> None:
    """The thread pool has forty."""
    job_id = submitted(own_api)
    url = f"{own_api.client.base_url}/v1/jobs/{job_id}"
    with ThreadPoolExecutor(55) as callers:
        waiting = [
            callers.submit(httpx.get, url, headers={"Prefer": "wait=30"}, timeout=40.0)
            for _ in range(55)
        ]
        time.sleep(1.5)
        start = time.monotonic()
        assert own_api.client.get(f"/v1/jobs/{job_id}").json()["state"] == "queued"
        quick_s = time.monotonic() - start
        finish(own_api.store, own_api.records, job_id, JobState.SUCCEEDED)
        answers = [one.result(timeout=30.0) for one in waiting]
    assert quick_s < 1.0
    assert {answer.json()["state"] for answer in answers} == {"succeeded"}


def test_where_too_many_wait_nothing_is_held(
    settings: ServiceSettings, serve: Callable[[ServiceSettings], Api]
) -> None:
    api = serve(settings.model_copy(update={"max_listeners": 1}))
    job_id = submitted(api)
    with api.client.stream("GET", f"/v1/jobs/{job_id}/events"):
        answer, took_s = asked(api, job_id, 30)
        assert (answer.status_code, took_s < 2.0) == (200, True)
        assert "preference-applied" not in answer.headers
        sent = api.client.post(
            "/v1/jobs/contours", json=CONTOUR_REQUEST, headers={"Prefer": "wait=30"}
        )
        assert sent.status_code == 202


def test_who_hangs_up_leaves_a_place(
    settings: ServiceSettings, serve: Callable[[ServiceSettings], Api]
) -> None:
    api = serve(settings.model_copy(update={"max_listeners": 1}))
    job_id = submitted(api)
    url = api.client.base_url
    with socket.create_connection((url.host, url.port), timeout=10.0) as connection:
        head = f"GET /v1/jobs/{job_id} HTTP/1.1\r\nHost: x\r\nPrefer: wait=60\r\n\r\n"
        connection.sendall(head.encode())
        wait_until(lambda: not is_held(api, job_id))
    wait_until(lambda: is_held(api, job_id))


def is_held(api: Api, job_id: str) -> bool:
    return "preference-applied" in asked(api, job_id, 0)[0].headers


@pytest.mark.parametrize("how", ["kill", "freeze"])
def test_what_was_accepted_stays_accepted_while_redis_is_away(
    own_api: Api, own_redis: RedisServer, how: str
) -> None:
    job_id = submitted(own_api)
    threading.Timer(0.5, getattr(own_redis, how)).start()
    answer, took_s = asked(own_api, job_id, 2)
    assert answer.status_code == 200
    assert answer.json()["state"] == "queued"
    assert took_s < 6.0


def test_what_was_accepted_and_then_erased_was_accepted(api: Api) -> None:
    def erase_it() -> None:
        wait_until(lambda: bool(api.records.ids()))
        time.sleep(0.3)
        assert api.client.delete(f"/v1/jobs/{api.records.ids()[0]}").status_code == 204

    with ThreadPoolExecutor(1) as other:
        erasing = other.submit(erase_it)
        answer = api.client.post(
            "/v1/jobs/contours", json=CONTOUR_REQUEST, headers={"Prefer": "wait=3"}
        )
        erasing.result()
    assert answer.status_code == 202
    assert answer.headers["location"] == answer.json()["links"]["self"]
