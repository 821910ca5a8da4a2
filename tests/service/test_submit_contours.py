import json
import threading
from collections.abc import Callable

import httpx
import pytest

from schemas.problem import ProblemType
from service.examples import CONTOUR_REQUEST
from service.settings import ServiceSettings
from tests.service.conftest import Api
from tests.service.test_jobs import problem_of
from tests.studies.catalogue import BAD_STUDIES, BadStudy

JSON = {"Content-Type": "application/json"}


@pytest.mark.parametrize("bad", BAD_STUDIES, ids=lambda bad: bad.name)
def test_a_bad_study_is_refused_and_leaves_nothing(api: Api, bad: BadStudy) -> None:
    answer = api.client.post("/v1/jobs/contours", content=bad.raw, headers=JSON)
    problem = problem_of(answer, bad.status, bad.type)
    assert problem.pointer == bad.pointer
    assert problem.fault == "caller"
    assert list(api.store.root.iterdir()) == []
    assert api.records.ids() == []


@pytest.mark.parametrize(
    "headers",
    [
        {"Content-Type": "text/plain"},
        {"Content-Type": "application/x-www-form-urlencoded"},
        {"Content-Type": ""},
        {**JSON, "Content-Encoding": "gzip"},
    ],
)
def test_only_plain_json_is_taken(api: Api, headers: dict[str, str]) -> None:
    answer = api.client.post(
        "/v1/jobs/contours", content=json.dumps(CONTOUR_REQUEST), headers=headers
    )
    problem_of(answer, 415, ProblemType.UNSUPPORTED_MEDIA_TYPE)


def test_a_charset_is_no_offence(api: Api) -> None:
    answer = api.client.post(
        "/v1/jobs/contours",
        content=json.dumps(CONTOUR_REQUEST),
        headers={"Content-Type": "application/json; charset=utf-8"},
    )
    assert answer.status_code == 202


@pytest.mark.parametrize("declared", [True, False])
@pytest.mark.parametrize(
    ("path", "content_type"),
    [("contours", "application/json"), ("labels", "multipart/form-data; boundary=b")],
)
def test_a_body_that_is_too_large_is_refused(
    serve: Callable[[ServiceSettings], Api],
    settings: ServiceSettings,
    path: str,
    content_type: str,
    declared: bool,
) -> None:
    """With its length in a header, and in chunks without one."""
    api = serve(settings.model_copy(update={"max_request_bytes": 100_000}))
    start = b'--b\r\nContent-Disposition: form-data; name="sax"; filename="a"\r\n\r\n'
    body = start + b"x" * 2_000_000
    pieces = (body[k : k + 50_000] for k in range(0, len(body), 50_000))
    answer = api.client.post(
        f"/v1/jobs/{path}",
        content=body if declared else pieces,
        headers={"Content-Type": content_type},
    )
    assert "100000 bytes" in problem_of(answer, 413, ProblemType.TOO_LARGE).detail
    assert list(api.store.root.iterdir()) == []


def test_a_small_content_length_is_not_believed(
    serve: Callable[[ServiceSettings], Api], settings: ServiceSettings
) -> None:
    api = serve(settings.model_copy(update={"max_request_bytes": 100_000}))
    answer = api.client.post(
        "/v1/jobs/contours", content=iter([b"x" * 60_000, b"x" * 60_000]), headers=JSON
    )
    problem_of(answer, 413, ProblemType.TOO_LARGE)


@pytest.mark.integration
def test_many_at_once_are_all_accepted_once(api: Api) -> None:
    ids: list[str] = []

    def submit() -> None:
        with httpx.Client(base_url=str(api.client.base_url), timeout=30.0) as client:
            for _ in range(5):
                answer = client.post("/v1/jobs/contours", json=CONTOUR_REQUEST)
                assert answer.status_code == 202, answer.text
                ids.append(answer.json()["id"])

    threads = [threading.Thread(target=submit) for _ in range(12)]
    for thread in threads:
        thread.start()
    for thread in threads:
        thread.join()
    assert len(ids) == len(set(ids)) == 60
    assert sorted(ids) == api.store.ids() == api.records.ids()
    assert "neuralmri_queue_depth 60.0" in api.client.get("/metrics").text
