"""A job's request, given back."""

from schemas.job import JobState
from schemas.problem import ProblemType
from service.examples import CONTOUR_REQUEST
from tests.service.conftest import Api
from tests.service.jobs_done import finish
from tests.service.test_jobs import problem_of, submitted
from tests.service.test_submit_labels import GOOD, form


def test_what_was_asked_is_given_back_and_asks_for_the_same(api: Api) -> None:
    job_id = submitted(api)
    given = api.client.get(f"/v1/jobs/{job_id}/request")
    assert given.status_code == 200
    assert given.headers["content-type"] == "application/json"
    assert given.headers["cache-control"] == "no-store"
    assert given.json()["study"]["subject_id"] == CONTOUR_REQUEST["study"]["subject_id"]
    again = api.client.post("/v1/jobs/contours", json=given.json())
    assert again.status_code == 202
    requests = [api.store.folder(id_).request().contours for id_ in (job_id, again.json()["id"])]
    assert requests[0] == requests[1]


def test_it_is_there_in_every_state_and_without_redis_knowing(api: Api) -> None:
    job_id = submitted(api)
    finish(api.store, api.records, job_id, JobState.FAILED)
    api.redis.flushall()
    assert api.client.get(f"/v1/jobs/{job_id}/request").is_success


def test_label_maps_are_not_given_back(api: Api) -> None:
    files = form(dict(GOOD.files()), dict(GOOD.request))
    job_id = api.client.post("/v1/jobs/labels", files=files).json()["id"]
    answer = api.client.get(f"/v1/jobs/{job_id}/request")
    problem = problem_of(answer, 409, ProblemType.INPUTS_NOT_SERVED)
    assert "neuralmri rerun" in problem.detail
    assert "retry-after" not in answer.headers


def test_an_unknown_job_has_none(api: Api) -> None:
    for job_id in ("0" * 32, "nonsense"):
        problem_of(api.client.get(f"/v1/jobs/{job_id}/request"), 404, ProblemType.NOT_FOUND)
    erased = submitted(api)
    api.client.delete(f"/v1/jobs/{erased}")
    problem_of(api.client.get(f"/v1/jobs/{erased}/request"), 404, ProblemType.NOT_FOUND)
