"""One `Idempotency-Key` makes one job, whatever happens in between."""

import json
import threading
from collections.abc import Callable
from concurrent.futures import ThreadPoolExecutor
from typing import Any

import httpx
import pytest

from jobs.queue import JobQueue
from jobs.reconcile import reconcile
from jobs.redis_client import make_redis
from schemas.job import JobState
from schemas.problem import ProblemType
from service import acceptance
from service.examples import CONTOUR_REQUEST
from service.settings import ServiceSettings
from tests.service.conftest import Api
from tests.service.jobs_done import finish
from tests.service.test_jobs import problem_of
from tests.service.test_submit_labels import GOOD, form
from tests.service.test_submit_references import STL

KEY = {"Idempotency-Key": "8e03978e-40d5-43e8-bc93-6894a57f9324"}


def post(api: Api, headers: dict[str, str] = KEY, **changes: Any) -> httpx.Response:
    body = {**CONTOUR_REQUEST, **changes}
    return api.client.post("/v1/jobs/contours", json=body, headers=headers)


def job_id(answer: httpx.Response, *, replayed: bool) -> str:
    assert answer.status_code == 202, answer.text
    assert answer.headers.get("idempotency-replayed") == ("true" if replayed else None)
    found: str = answer.json()["id"]
    assert answer.headers["location"] == f"/v1/jobs/{found}"
    assert int(answer.headers["retry-after"]) > 0
    return found


def test_the_same_request_is_the_same_job(api: Api) -> None:
    first = job_id(post(api), replayed=False)
    assert [job_id(post(api), replayed=True) for _ in range(3)] == [first] * 3
    assert api.store.ids() == api.records.ids() == [first]
    other = job_id(post(api, {"Idempotency-Key": "another"}), replayed=False)
    without = [job_id(post(api, {}), replayed=False) for _ in range(2)]
    assert len({first, other, *without}) == 4


@pytest.mark.parametrize("state", [JobState.SUCCEEDED, JobState.FAILED])
def test_a_job_that_has_ended_is_found_as_it_stands(api: Api, state: JobState) -> None:
    first = job_id(post(api), replayed=False)
    finish(api.store, api.records, first, state)
    again = post(api)
    assert job_id(again, replayed=True) == first
    assert again.json() == api.client.get(f"/v1/jobs/{first}").json()
    assert again.json()["state"] == state


def test_white_space_and_order_of_keys_do_not_count(api: Api) -> None:
    first = job_id(post(api), replayed=False)
    shuffled = dict(reversed(CONTOUR_REQUEST.items()))
    answer = api.client.post(
        "/v1/jobs/contours",
        content=json.dumps(shuffled, indent=3),
        headers={**KEY, "Content-Type": "application/json"},
    )
    assert job_id(answer, replayed=True) == first


def test_another_request_under_the_key_is_refused(api: Api) -> None:
    first = job_id(post(api), replayed=False)
    options = {**CONTOUR_REQUEST["options"], "seed": 7}
    labels = form(GOOD.files(), dict(GOOD.request))
    for answer in (
        post(api, options=options),
        api.client.post("/v1/jobs/contours?priority=batch", json=CONTOUR_REQUEST, headers=KEY),
        api.client.post("/v1/jobs/labels", files=labels, headers=KEY),
    ):
        problem = problem_of(answer, 422, ProblemType.IDEMPOTENCY_KEY_REUSED)
        assert "Remedy" in problem.detail
    assert api.store.ids() == [first]


def test_every_byte_of_every_file_counts(api: Api) -> None:
    files = GOOD.files()
    labels = form({**files, "reference_ED_lv_endo": STL}, dict(GOOD.request))

    def send(parts: Any) -> httpx.Response:
        return api.client.post("/v1/jobs/labels", files=parts, headers=KEY)

    first = job_id(send(labels), replayed=False)
    assert job_id(send(labels), replayed=True) == first
    inputs = api.store.folder(first).path / "inputs"
    assert (inputs / "reference_ED_lv_endo.stl").read_bytes() == STL, "hashing left it whole"
    changed = form({**files, "reference_ED_lv_endo": b"x" + STL[1:]}, dict(GOOD.request))
    problem_of(send(changed), 422, ProblemType.IDEMPOTENCY_KEY_REUSED)
    problem_of(send(form(files, dict(GOOD.request))), 422, ProblemType.IDEMPOTENCY_KEY_REUSED)


def test_an_erased_job_takes_its_key_with_it(api: Api) -> None:
    first = job_id(post(api), replayed=False)
    assert api.client.delete(f"/v1/jobs/{first}").status_code == 204
    second = job_id(post(api, options={"preset": "standard"}), replayed=False)
    assert api.store.ids() == [second] != [first]


def test_an_erasure_that_redis_did_not_hear_of(api: Api) -> None:
    first = job_id(post(api), replayed=False)
    api.store.folder(first).erase()
    second = job_id(post(api), replayed=False)
    assert job_id(post(api), replayed=True) == second
    assert api.records.ids() == [second]


@pytest.mark.parametrize("reconciled", [True, False])
def test_the_key_outlives_redis(api: Api, reconciled: bool) -> None:
    """Also in the moments before the reconciler's next round."""
    first = job_id(post(api), replayed=False)
    finish(api.store, api.records, first, JobState.SUCCEEDED)
    with make_redis(api.settings.redis_url) as redis:
        redis.flushall()
        if reconciled:
            queue = JobQueue(api.settings, redis)
            assert reconcile(api.store, api.records, queue, 3600.0).ended == (first,)
    again = post(api)
    assert job_id(again, replayed=True) == first
    assert again.json()["state"] == "succeeded"
    problem_of(post(api, options={}), 422, ProblemType.IDEMPOTENCY_KEY_REUSED)
    assert api.store.ids() == [first]


def test_records_are_whole_after_a_round_that_nothing_disturbed(api: Api) -> None:
    with make_redis(api.settings.redis_url) as redis:
        assert not api.records.wholeness.is_certain()
        begun = api.records.wholeness.begin_round()
        redis.flushall()
        api.records.wholeness.end_round(begun)
        assert not api.records.wholeness.is_certain(), "emptied in the middle"
        reconcile(api.store, api.records, JobQueue(api.settings, redis), 3600.0)
        assert api.records.wholeness.is_certain()
        redis.set("neuralmri:records-are-whole", "the run id of before a restart")
        assert not api.records.wholeness.is_certain()


@pytest.mark.integration
def test_many_at_once_with_one_key_are_one_job(api: Api) -> None:
    start = threading.Barrier(12)

    def send(_: int) -> httpx.Response:
        with httpx.Client(base_url=str(api.client.base_url), timeout=30.0) as client:
            start.wait()
            return client.post("/v1/jobs/contours", json=CONTOUR_REQUEST, headers=KEY)

    with ThreadPoolExecutor(12) as pool:
        answers = list(pool.map(send, range(12)))
    assert [a.status_code for a in answers] == [202] * 12
    assert len({a.json()["id"] for a in answers}) == 1
    assert sorted("idempotency-replayed" in a.headers for a in answers) == [False] + [True] * 11
    assert api.store.ids() == api.records.ids() == [answers[0].json()["id"]]


def test_who_comes_while_the_first_is_being_written_is_told_to_come_back(
    api: Api, monkeypatch: pytest.MonkeyPatch
) -> None:
    monkeypatch.setattr(acceptance, "_PATIENCE_S", 0.1)
    submit = acceptance.submit
    arrived, go_on = threading.Event(), threading.Event()

    def slow(*arguments: Any) -> Any:
        arrived.set()
        assert go_on.wait(20.0)
        return submit(*arguments)

    monkeypatch.setattr(acceptance, "submit", slow)
    with ThreadPoolExecutor(1) as pool:
        first = pool.submit(post, api)
        assert arrived.wait(20.0)
        try:
            with httpx.Client(base_url=str(api.client.base_url), timeout=30.0) as client:
                early = client.post("/v1/jobs/contours", json=CONTOUR_REQUEST, headers=KEY)
        finally:
            go_on.set()
        problem_of(early, 409, ProblemType.IDEMPOTENCY_KEY_PENDING)
        assert early.headers["retry-after"] == "1"
        assert job_id(first.result(), replayed=False) == job_id(post(api), replayed=True)


def test_a_request_that_failed_may_be_sent_again(api: Api, monkeypatch: pytest.MonkeyPatch) -> None:
    def full(*_: Any) -> Any:
        raise OSError(28, "No space left on device")

    with monkeypatch.context() as patch:
        patch.setattr(acceptance, "submit", full)
        problem_of(post(api), 507, ProblemType.STORAGE_FULL)
    job_id(post(api), replayed=False)


@pytest.mark.parametrize("key", ["", "k" * 256, "caf\xe9", "tab\there"])
def test_a_key_is_short_printable_ascii(api: Api, key: str) -> None:
    answer = post(api, {"Idempotency-Key": key.encode("latin-1")})  # type: ignore[dict-item]
    problem = problem_of(answer, 422, ProblemType.INVALID_REQUEST)
    assert problem.pointer == "/header/idempotency-key"
    assert list(api.store.root.iterdir()) == []


@pytest.mark.parametrize("key", ["k", "~" * 255, '"quoted: *[]?"'])
def test_any_printable_key_will_do(api: Api, key: str) -> None:
    first = job_id(post(api, {"Idempotency-Key": key}), replayed=False)
    assert job_id(post(api, {"Idempotency-Key": key}), replayed=True) == first


def test_a_full_queue_still_finds_what_it_took(
    serve: Callable[[ServiceSettings], Api], settings: ServiceSettings, redis: Any
) -> None:
    api = serve(settings.model_copy(update={"max_queued_jobs": 1}))
    first = job_id(post(api), replayed=False)
    problem_of(post(api, {"Idempotency-Key": "new"}), 503, ProblemType.QUEUE_FULL)
    assert job_id(post(api), replayed=True) == first
