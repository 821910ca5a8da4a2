"""An earlier result is had again by wish, only where content, code and owner agree."""

from collections.abc import Callable
from copy import deepcopy
from datetime import UTC, datetime
from typing import Any

import httpx
import pytest

from jobs.reconcile import reconcile
from schemas.job import JobState
from schemas.messages import Outcome
from schemas.problem import ProblemType
from service.access import JobAccess
from service.examples import CONTOUR_REQUEST
from service.settings import ServiceSettings
from tests.service.callers import bearer, new_key
from tests.service.conftest import Api
from tests.service.jobs_done import claim, finish
from tests.service.test_jobs import problem_of
from tests.service.test_submit_labels import GOOD, form

CODE = "c" * 64


def asked(
    api: Api, body: dict[str, Any] = CONTOUR_REQUEST, reuse: bool = True, **headers: str
) -> httpx.Response:
    query = {"reuse": "true"} if reuse else {}
    answer = api.client.post("/v1/jobs/contours", params=query, json=body, headers=headers)
    assert answer.status_code in (200, 202), answer.text
    return answer


def is_reused(answer: httpx.Response, job_id: str) -> bool:
    is_said = answer.headers.get("result-reused") == "true"
    assert is_said == (answer.status_code == 200)
    assert answer.headers["location"] == f"/v1/jobs/{answer.json()['id']}"
    return is_said and answer.json()["id"] == job_id


def done(api: Api, job_id: str, code: str | None = CODE) -> str:
    """Succeeded by a worker of this code."""
    folder = api.store.folder(job_id)
    now = datetime.now(tz=UTC)
    folder.write_outcome(
        Outcome(
            state=JobState.SUCCEEDED, started_at=now, finished_at=now, attempt=1, code_version=code
        )
    )
    finish(api.store, api.records, job_id, JobState.SUCCEEDED)
    return job_id


def first(api: Api, **headers: str) -> str:
    api.workers.heartbeat("worker@test", code_version=CODE)
    job_id: str = asked(api, reuse=False, **headers).json()["id"]
    return job_id


def test_the_same_is_had_again_and_nothing_is_queued(api: Api) -> None:
    job_id = done(api, first(api))
    answer = asked(api)
    assert is_reused(answer, job_id)
    assert answer.json()["state"] == "succeeded"
    assert "retry-after" not in answer.headers
    assert api.store.ids() == [job_id]
    assert not is_reused(asked(api, reuse=False), job_id), "by wish only"


def test_spelling_out_a_default_is_the_same_content_and_another_seed_is_not(api: Api) -> None:
    job_id = done(api, first(api))
    body: dict[str, Any] = deepcopy(CONTOUR_REQUEST)
    body["options"] = {**body.get("options", {}), "levels": 4}
    assert is_reused(asked(api, body), job_id)
    body["options"]["seed"] = 77
    assert not is_reused(asked(api, body), job_id)


@pytest.mark.parametrize("state", [JobState.FAILED, JobState.CANCELLED])
def test_only_what_succeeded_is_had_again(api: Api, state: JobState) -> None:
    job_id = first(api)
    if state is JobState.CANCELLED:
        api.client.post(f"/v1/jobs/{job_id}/cancel")
    else:
        token, now = claim(api.records, job_id), datetime.now(tz=UTC)
        outcome = Outcome(
            state=state, started_at=now, finished_at=now, attempt=1, code_version=CODE
        )
        api.records.finished(job_id, token, outcome)
    assert not is_reused(asked(api), job_id)


def test_other_code_is_not_had_again(api: Api) -> None:
    unknown = done(api, first(api), None)
    other = done(api, first(api), "d" * 64)
    assert asked(api).json()["id"] not in (unknown, other)
    api.workers.heartbeat("other@test", code_version="d" * 64)
    assert is_reused(asked(api), other), "a live worker would do it by that code"


def test_without_a_worker_nobody_knows_the_code(api: Api) -> None:
    job_id = done(api, first(api))
    api.redis.delete("neuralmri:workers")
    assert not is_reused(asked(api), job_id)


def test_an_erased_job_is_not_had_again(api: Api) -> None:
    job_id = done(api, first(api))
    api.client.delete(f"/v1/jobs/{job_id}")
    assert not is_reused(asked(api), job_id)
    ghost = done(api, first(api))
    api.store.folder(ghost).erase()
    assert not is_reused(asked(api), ghost), "the folder has the last word"


def test_it_is_known_again_after_the_loss_of_redis(api: Api) -> None:
    job_id = done(api, first(api))
    api.redis.flushall()
    access = JobAccess.of_settings(api.settings)
    reconcile(access.store, access.records, access.queue, 30.0)
    api.workers.heartbeat("worker@test", code_version=CODE)
    assert is_reused(asked(api), job_id)


def test_no_owner_has_another_ones_result(
    settings: ServiceSettings, serve: Callable[[ServiceSettings], Api]
) -> None:
    (_, mine), (_, theirs) = (new_key(settings.data_dir, name) for name in ("ours", "theirs"))
    api = serve(settings)
    job_id = done(api, first(api, **bearer(mine)))
    assert not is_reused(asked(api, **bearer(theirs)), job_id)
    assert is_reused(asked(api, **bearer(mine)), job_id)


def test_a_known_key_stands_for_its_own_job(api: Api) -> None:
    key = {"Idempotency-Key": "k"}
    keyed = first(api, **key)
    done(api, first(api))
    answer = asked(api, **key)
    assert answer.json()["id"] == keyed
    assert answer.headers["idempotency-replayed"] == "true"


def test_label_maps_agree_by_their_bytes(api: Api) -> None:
    api.workers.heartbeat("worker@test", code_version=CODE)
    parts = form(dict(GOOD.files()), dict(GOOD.request))
    job_id = done(api, api.client.post("/v1/jobs/labels", files=parts).json()["id"])
    again = api.client.post("/v1/jobs/labels", params={"reuse": "true"}, files=parts)
    assert is_reused(again, job_id)


def test_a_restart_without_a_change_is_the_same_content(api: Api) -> None:
    job_id = done(api, first(api))
    query = {"reuse": "true"}
    answer = api.client.post(f"/v1/jobs/{job_id}/restart", params=query)
    assert is_reused(answer, job_id)
    other = {"options": {"seed": 9}}
    answer = api.client.post(f"/v1/jobs/{job_id}/restart", params=query, json=other)
    assert answer.status_code == 202


def test_an_earlier_job_joins_no_batch(api: Api) -> None:
    batch = api.client.post("/v1/batches").json()["id"]
    address = f"/v1/jobs/contours?reuse=true&batch={batch}"
    answer = api.client.post(address, json=CONTOUR_REQUEST)
    assert problem_of(answer, 422, ProblemType.INVALID_REQUEST).pointer == "/query/reuse"
    assert api.store.ids() == []
