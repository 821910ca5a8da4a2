from datetime import datetime

import httpx
import pytest

from schemas.job import JobState
from schemas.problem import Problem, ProblemType
from service.examples import CONTOUR_REQUEST
from tests.service.conftest import Api
from tests.service.jobs_done import claim, finish


def submitted(api: Api) -> str:
    answer = api.client.post("/v1/jobs/contours", json=CONTOUR_REQUEST)
    assert answer.status_code == 202, answer.text
    job_id: str = answer.json()["id"]
    return job_id


def problem_of(answer: httpx.Response, status: int, type_: ProblemType) -> Problem:
    assert answer.status_code == status, answer.text
    assert answer.headers["content-type"] == "application/problem+json"
    problem = Problem.model_validate(answer.json())
    assert problem.type == type_.uri
    assert problem.status == status
    return problem


def test_a_submission_is_accepted_and_can_be_followed(api: Api) -> None:
    answer = api.client.post("/v1/jobs/contours", json=CONTOUR_REQUEST)
    assert answer.status_code == 202
    job = answer.json()
    assert answer.headers["location"] == f"/v1/jobs/{job['id']}" == job["links"]["self"]
    assert int(answer.headers["retry-after"]) > 0
    assert (job["state"], job["kind"], job["progress"]["stage"]) == (
        "queued",
        "contours",
        "waiting",
    )
    assert datetime.fromisoformat(job["created_at"]).utcoffset() is not None
    followed = api.client.get(answer.headers["location"])
    assert followed.status_code == 200
    assert followed.json() == job
    assert int(followed.headers["retry-after"]) > 0
    request = api.store.folder(job["id"]).request()
    assert request.contours is not None
    assert request.contours.study.subject_id == "case-01"


def test_the_end_is_seen(api: Api) -> None:
    job_id = submitted(api)
    finish(api.store, api.records, job_id, JobState.SUCCEEDED)
    answer = api.client.get(f"/v1/jobs/{job_id}")
    assert answer.json()["state"] == "succeeded"
    assert answer.json()["progress"]["fraction"] == 1.0
    assert "retry-after" not in answer.headers


@pytest.mark.parametrize("job_id", ["0" * 32, "nonsense", "..", "%2e%2e%2fetc", "A" * 32])
@pytest.mark.parametrize(
    ("method", "path"),
    [
        ("GET", ""),
        ("POST", "/cancel"),
        ("GET", "/report"),
        ("GET", "/artifacts"),
        ("GET", "/artifacts/report.json"),
    ],
)
def test_unknown_jobs(api: Api, job_id: str, method: str, path: str) -> None:
    answer = api.client.request(method, f"/v1/jobs/{job_id}{path}")
    assert answer.status_code == 404 or (job_id == ".." and answer.status_code == 405)
    assert answer.headers["content-type"] == "application/problem+json"


def test_pages(api: Api) -> None:
    ids = [submitted(api) for _ in range(5)]
    api.client.post(f"/v1/jobs/{ids[1]}/cancel")
    seen: list[str] = []
    cursor: dict[str, str] = {}
    while True:
        page = api.client.get("/v1/jobs", params={"limit": 2, **cursor}).json()
        seen += [job["id"] for job in page["jobs"]]
        if page["next_cursor"] is None:
            break
        cursor = {"cursor": page["next_cursor"]}
    assert seen == ids[::-1]
    cancelled = api.client.get("/v1/jobs", params={"state": "cancelled"}).json()
    assert [job["id"] for job in cancelled["jobs"]] == [ids[1]]


@pytest.mark.parametrize(
    "query", ["limit=0", "limit=201", "limit=x", "state=done", "cursor=../..", "cursor=[x"]
)
def test_bad_parameters_are_named(api: Api, query: str) -> None:
    problem = problem_of(api.client.get(f"/v1/jobs?{query}"), 422, ProblemType.INVALID_REQUEST)
    assert problem.pointer == f"/query/{query.partition('=')[0]}"


def test_cancelling_a_queued_job_twice(api: Api) -> None:
    job_id = submitted(api)
    first = api.client.post(f"/v1/jobs/{job_id}/cancel")
    second = api.client.post(f"/v1/jobs/{job_id}/cancel")
    assert first.status_code == second.status_code == 200
    assert first.json() == second.json()
    assert first.json()["state"] == "cancelled"
    outcome = api.store.folder(job_id).outcome()
    assert outcome is not None
    assert outcome.state is JobState.CANCELLED


def test_cancelling_a_running_job(api: Api) -> None:
    job_id = submitted(api)
    claim(api.records, job_id)
    for _ in range(2):
        answer = api.client.post(f"/v1/jobs/{job_id}/cancel")
        assert answer.status_code == 202
        assert answer.json()["state"] == "cancelling"
        assert "retry-after" in answer.headers
    assert api.store.folder(job_id).outcome() is None


@pytest.mark.parametrize("state", [JobState.SUCCEEDED, JobState.FAILED])
def test_cancelling_too_late_changes_nothing(api: Api, state: JobState) -> None:
    job_id = submitted(api)
    finish(api.store, api.records, job_id, state)
    before = api.client.get(f"/v1/jobs/{job_id}").json()
    answer = api.client.post(f"/v1/jobs/{job_id}/cancel")
    assert answer.status_code == 200
    assert answer.json() == before
    assert before["state"] == state


def test_erasing_twice(api: Api) -> None:
    job_id = submitted(api)
    finish(api.store, api.records, job_id, JobState.SUCCEEDED)
    for _ in range(2):
        answer = api.client.delete(f"/v1/jobs/{job_id}")
        assert answer.status_code == 204
        assert answer.content == b""
    assert api.client.get(f"/v1/jobs/{job_id}").status_code == 404
    assert api.client.get("/v1/jobs").json()["jobs"] == []
    assert list(api.store.root.iterdir()) == []


def test_erasing_a_running_job_stops_its_worker(api: Api) -> None:
    job_id = submitted(api)
    token = claim(api.records, job_id)
    assert api.client.delete(f"/v1/jobs/{job_id}").status_code == 204
    assert not api.records.renew(job_id, token, 30.0)
    assert list(api.store.root.iterdir()) == []


def test_erasing_nonsense(api: Api) -> None:
    problem_of(api.client.delete("/v1/jobs/nonsense"), 404, ProblemType.NOT_FOUND)


def test_a_job_that_redis_forgot_is_still_there(api: Api) -> None:
    job_id = submitted(api)
    finish(api.store, api.records, job_id, JobState.SUCCEEDED)
    before = api.client.get(f"/v1/jobs/{job_id}").json()
    api.records.forget(job_id)
    assert api.client.get(f"/v1/jobs/{job_id}").json() == before


@pytest.mark.parametrize("path", ["/v1/jobs/contours", "/v1/jobs/labels"])
def test_an_address_of_its_own_is_not_taken_for_a_job_s(api: Api, path: str) -> None:
    answer = api.client.put(path)
    problem_of(answer, 405, ProblemType.METHOD_NOT_ALLOWED)
    assert answer.headers["allow"] == "POST"
