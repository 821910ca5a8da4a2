"""The closed table of attacks: what is tried, and the answer that each has to get."""

import http.client
import json
import socket
from datetime import timedelta
from typing import Any

import httpx
import pytest

from jobs.redis_client import make_redis
from schemas.api_key import Scope
from schemas.job import JobState
from schemas.problem import ProblemType
from service.examples import CONTOUR_REQUEST
from service.keys import keyring
from service.keys.key_file import KeyFile
from service.settings import ServiceSettings
from tests.service.callers import ALL, Serve, bearer, filled, new_key, operations, submit_as
from tests.service.conftest import Api
from tests.service.jobs_done import MESH, finish
from tests.service.test_jobs import problem_of

UNKNOWN = f"{1:032x}"


@pytest.fixture
def token(keyed: Api) -> str:
    return new_key(keyed.settings.data_dir, "ours")[1]


# Credentials that open nothing: name -> headers, from a key's id and token that are good.
FORGED: dict[str, Any] = {
    "none": lambda _id, _token: {},
    "empty": lambda _id, _token: {"Authorization": "Bearer"},
    "empty header": lambda _id, _token: {"X-API-Key": ""},
    "another scheme": lambda _id, token: {"Authorization": f"Token {token}"},
    "basic": lambda _id, token: {"Authorization": f"Basic {token}"},
    "no scheme": lambda _id, token: {"Authorization": token},
    "cookie": lambda _id, token: {"Cookie": f"api_key={token}"},
    "id alone": lambda id_, _token: bearer(id_),
    "no secret": lambda id_, _token: bearer(f"nmri_{id_}_"),
    "secret alone": lambda _id, token: bearer(token.rpartition("_")[2]),
    "cut short": lambda _id, token: bearer(token[:-1]),
    "one more": lambda _id, token: bearer(token + "0"),
    "one digit wrong": lambda _id, token: bearer(token[:-1] + ("1" if token[-1] == "0" else "0")),
    "its hash": lambda id_, token: bearer(f"nmri_{id_}_{'0' * 64}"),
    "another's id": lambda _id, token: bearer(f"nmri_{'0' * 16}_{token[-64:]}"),
    "upper case": lambda _id, token: bearer(token.upper()),
    "two in one": lambda _id, token: bearer(f"{token}, {token}"),
    "a path": lambda _id, token: bearer(f"nmri_../../keys.json_{token[-64:]}"),
    "a wildcard": lambda _id, _token: bearer("nmri_*_*"),
    "not ASCII": lambda _id, token: {"Authorization": f"Bearer {token[:-1]}²".encode("latin-1")},
    "8 KiB": lambda _id, token: bearer(token + "0" * 8192),
}


@pytest.mark.parametrize("forgery", FORGED)
def test_what_is_no_key_opens_no_operation(keyed: Api, forgery: str) -> None:
    key_id, token = new_key(keyed.settings.data_dir, "ours")
    job_id = submit_as(keyed, token)
    headers = FORGED[forgery](key_id, token)
    for method, path in operations(keyed):
        answer = keyed.client.request(method, filled(path, job_id), headers=headers)
        assert answer.status_code == 401, (method, path)
        assert answer.headers["www-authenticate"].startswith('Bearer realm="neuralmri"')
        assert answer.headers["cache-control"] == "no-store"
        if method != "HEAD":
            problem_of(answer, 401, ProblemType.UNAUTHENTICATED)
            assert token[-64:] not in answer.text
    assert keyed.store.folder(job_id).outcome() is None


def test_a_key_in_the_query_is_no_key(keyed: Api, token: str) -> None:
    for name in ("api_key", "key", "access_token", "token"):
        assert keyed.client.get("/v1/jobs", params={name: token}).status_code == 401


def test_two_different_keys_are_refused_and_one_said_twice_is_not(keyed: Api, token: str) -> None:
    other = new_key(keyed.settings.data_dir, "theirs")[1]
    both = {**bearer(token), "X-API-Key": other}
    assert keyed.client.get("/v1/jobs", headers=both).status_code == 401
    twice = {**bearer(token), "X-API-Key": token}
    assert keyed.client.get("/v1/jobs", headers=twice).status_code == 200


@pytest.mark.parametrize(
    "headers",
    [
        lambda token: {"X-API-Key": token},
        lambda token: {"x-api-key": token},
        lambda token: {"Authorization": f"bearer {token}"},
        lambda token: {"Authorization": "Basic cHJveHk6eA==", "X-API-Key": token},
    ],
)
def test_a_key_is_taken_from_either_header(keyed: Api, token: str, headers: Any) -> None:
    assert keyed.client.get("/v1/jobs", headers=headers(token)).status_code == 200


def test_a_header_beyond_all_measure_is_closed_by_the_protocol(keyed: Api, token: str) -> None:
    try:
        answer = keyed.client.get("/v1/jobs", headers=bearer(token + "0" * 200_000))
    except httpx.TransportError:
        return  # cut off while it was sent
    assert answer.status_code in (400, 431)


@pytest.mark.parametrize("end", ["expired", "revoked"])
def test_a_key_at_its_end_opens_nothing_and_says_so_to_who_has_it(keyed: Api, end: str) -> None:
    data_dir = keyed.settings.data_dir
    lifetime = timedelta(microseconds=1) if end == "expired" else None
    key_id, token = new_key(data_dir, "ours", lifetime=lifetime)
    if end == "revoked":
        assert keyed.client.get("/v1/jobs", headers=bearer(token)).status_code == 200
        keyring.revoke(KeyFile(data_dir), key_id)
    for method, path in operations(keyed):
        answer = keyed.client.request(method, filled(path, UNKNOWN), headers=bearer(token))
        assert answer.status_code == 401
        assert 'error="invalid_token"' in answer.headers["www-authenticate"]
    detail = keyed.client.get("/v1/jobs", headers=bearer(token)).json()["detail"]
    assert end in detail
    guessed = keyed.client.get("/v1/jobs", headers=bearer(f"nmri_{key_id}_{'0' * 64}"))
    assert end not in guessed.json()["detail"], "only who has the secret learns of the key"


def test_every_operation_names_the_scope_that_a_key_lacks(keyed: Api) -> None:
    data_dir = keyed.settings.data_dir
    keys = {scope: new_key(data_dir, "ours", scope)[1] for scope in ALL}
    job_id = submit_as(keyed, keys[Scope.SUBMIT])
    for method, path in operations(keyed):
        needed = Scope.READ if method in ("GET", "HEAD") else Scope.SUBMIT
        (other,) = set(ALL) - {needed}
        answer = keyed.client.request(method, filled(path, job_id), headers=bearer(keys[other]))
        assert answer.status_code == 403, (method, path)
        challenge = answer.headers["www-authenticate"]
        assert f'error="insufficient_scope", scope="{needed}"' in challenge
        if method != "HEAD":
            assert f"`{needed}`" in problem_of(answer, 403, ProblemType.MISSING_SCOPE).detail
    assert keyed.store.folder(job_id).outcome() is None


def answer_of(answer: httpx.Response, job_id: str) -> tuple[int, str, list[tuple[str, str]]]:
    """All that a caller sees, without the id, the clock, and the count of its own requests."""
    counted = ("date", "ratelimit")
    headers = [(n, v) for n, v in answer.headers.multi_items() if n not in counted]
    return answer.status_code, answer.text.replace(job_id, "ID"), headers


@pytest.mark.parametrize("state", [JobState.QUEUED, JobState.SUCCEEDED, JobState.FAILED])
def test_anothers_job_is_answered_like_one_that_never_was(
    keyed: Api, token: str, state: JobState
) -> None:
    theirs = new_key(keyed.settings.data_dir, "theirs")[1]
    job_id = submit_as(keyed, theirs)
    if state is not JobState.QUEUED:
        finish(keyed.store, keyed.records, job_id, state)
    before = keyed.client.get(f"/v1/jobs/{job_id}", headers=bearer(theirs)).json()
    tried = [(m, p) for m, p in operations(keyed) if "{job_id}" in p]
    assert {("DELETE", "/v1/jobs/{job_id}"), ("GET", "/v1/jobs/{job_id}/request")} <= set(tried)
    for method, path in tried:
        # One trace: an id of its own in each answer would tell nothing.
        headers = {**bearer(token), "traceparent": f"00-{'a' * 32}-{'b' * 16}-00"}
        real, never = (
            answer_of(
                keyed.client.request(method, filled(path, tried_id), headers=headers), tried_id
            )
            for tried_id in (job_id, UNKNOWN)
        )
        assert real == never, (method, path)
        assert real[0] == 404
    assert keyed.client.get(f"/v1/jobs/{job_id}", headers=bearer(theirs)).json() == before
    listed = keyed.client.get("/v1/jobs", headers=bearer(token)).json()
    assert listed == {"jobs": [], "next_cursor": None}
    paged = keyed.client.get("/v1/jobs", params={"cursor": "f" * 32}, headers=bearer(token)).json()
    assert paged["jobs"] == []


def test_an_owner_has_all_of_its_jobs_whichever_of_its_keys_made_them(keyed: Api) -> None:
    data_dir = keyed.settings.data_dir
    first, second = (new_key(data_dir, "ours")[1] for _ in range(2))
    job_id = submit_as(keyed, first)
    finish(keyed.store, keyed.records, job_id, JobState.SUCCEEDED)
    mine = bearer(second)
    listed = keyed.client.get("/v1/jobs", headers=mine).json()["jobs"]
    assert [job["id"] for job in listed] == [job_id]
    mesh = keyed.client.get(f"/v1/jobs/{job_id}/artifacts/ED_lv_endo.stl", headers=mine)
    assert mesh.content == MESH
    for _ in range(2):
        assert keyed.client.delete(f"/v1/jobs/{job_id}", headers=mine).status_code == 204
    stranger = bearer(new_key(data_dir, "theirs")[1])
    assert keyed.client.delete(f"/v1/jobs/{job_id}", headers=stranger).status_code == 404
    assert keyed.client.get(f"/v1/jobs/{job_id}", headers=mine).status_code == 404


def test_an_administrator_has_everybodys(keyed: Api) -> None:
    data_dir = keyed.settings.data_dir
    ids = [submit_as(keyed, new_key(data_dir, owner)[1]) for owner in ("a", "b")]
    admin = bearer(new_key(data_dir, "c", Scope.ADMIN)[1])
    listed = keyed.client.get("/v1/jobs", headers=admin).json()["jobs"]
    assert [job["id"] for job in listed] == ids[::-1]
    assert keyed.client.post(f"/v1/jobs/{ids[0]}/cancel", headers=admin).status_code == 200
    for _ in range(2):
        assert keyed.client.delete(f"/v1/jobs/{ids[1]}", headers=admin).status_code == 204


def test_results_belong_to_their_owner_without_redis_too(keyed: Api, token: str) -> None:
    job_id = submit_as(keyed, token)
    finish(keyed.store, keyed.records, job_id, JobState.SUCCEEDED)
    keyed.records.forget(job_id)
    theirs = new_key(keyed.settings.data_dir, "theirs")[1]
    for path in ("/report", "/artifacts", "/artifacts/ED_lv_endo.stl"):
        url = f"/v1/jobs/{job_id}{path}"
        assert keyed.client.get(url, headers=bearer(theirs)).status_code == 404
        # The report of the tests is no whole one, and is served as it is.
        assert keyed.client.get(url, headers=bearer(token)).status_code == 200


def test_a_record_that_is_read_from_its_folder_keeps_its_owner(keyed: Api, token: str) -> None:
    job_id = submit_as(keyed, token)
    keyed.records.forget(job_id)
    assert keyed.client.get(f"/v1/jobs/{job_id}", headers=bearer(token)).status_code == 200
    assert [job.id for job in keyed.records.page("ours").jobs] == [job_id]
    assert keyed.records.page("anonymous").jobs == []


# Raw request targets, which no client library has tidied up.
@pytest.mark.parametrize(
    "target",
    [
        "/v1/jobs/",
        "//v1/jobs",
        "/v1//jobs",
        "/./v1/jobs",
        "/healthz/../v1/jobs",
        "/healthz/%2e%2e/v1/jobs",
        "/healthz%2f..%2fv1%2fjobs",
        "/readyz;/v1/jobs",
        "/v1/jobs?x=/healthz",
        "/v1/jobs#/healthz",
        "/V1/JOBS",
        "/v1/jobs/{id}/../{id}",
        "/v1/jobs/{id}%2freport",
        "/v1/jobs/{id}%00",
        "/v1/jobs/{id}%0a",
        "/v1/jobs/{id}/artifacts/..%2f..%2frequest.json",
        "/v1/jobs/{id}/artifacts/%2e%2e/request.json",
        "/v1/jobs/../../keys.json",
        "/keys.json",
        "/audit/done.jsonl",
        "http://127.0.0.1/v1/jobs",
    ],
)
def test_no_spelling_of_an_address_gets_round_the_door(keyed: Api, token: str, target: str) -> None:
    job_id = submit_as(keyed, token)
    finish(keyed.store, keyed.records, job_id, JobState.SUCCEEDED)
    stranger = new_key(keyed.settings.data_dir, "theirs")[1]
    url = keyed.client.base_url
    for headers in ({}, bearer(stranger)):
        connection = http.client.HTTPConnection(url.host, url.port, timeout=10.0)
        connection.request("GET", target.replace("{id}", job_id), headers=headers)
        answer = connection.getresponse()
        body = answer.read()
        connection.close()
        if headers and answer.status == 200:
            assert json.loads(body)["jobs"] == [], "the stranger's own list"
        else:
            assert answer.status in (307, 400, 401, 404), answer.status
        assert job_id.encode() not in body or answer.status != 200


def test_nobody_is_let_send_a_body_before_the_key_is_looked_at(keyed: Api) -> None:
    url = keyed.client.base_url
    assert url.port is not None
    with socket.create_connection((url.host, url.port), timeout=5.0) as line:
        line.sendall(
            b"POST /v1/jobs/contours HTTP/1.1\r\nHost: x\r\nContent-Type: application/json\r\n"
            b"Content-Length: 20000000\r\n\r\n"
        )
        assert line.recv(4096).startswith(b"HTTP/1.1 401 ")


def test_a_large_submission_without_a_key_is_told_so(keyed: Api) -> None:
    body = json.dumps({**CONTOUR_REQUEST, "padding": "x" * 8_000_000})
    answer = keyed.client.post(
        "/v1/jobs/contours", content=body, headers={"Content-Type": "application/json"}
    )
    problem_of(answer, 401, ProblemType.UNAUTHENTICATED)


@pytest.mark.parametrize("path", ["/healthz", "/readyz"])
def test_health_is_open(keyed: Api, path: str) -> None:
    keyed.workers.heartbeat("worker@test")
    keyed.workers.finished_heartbeat()
    for headers in ({}, bearer("nonsense")):
        assert keyed.client.get(path, headers=headers).status_code == 200


def test_without_any_key_the_service_asks_for_none(api: Api) -> None:
    assert api.client.get("/v1/jobs").status_code == 200
    assert api.client.get("/v1/jobs", headers=bearer("a proxy's own")).status_code == 200
    assert api.client.get("/metrics").status_code == 200


def test_the_first_key_closes_the_door_of_a_running_service(
    settings: ServiceSettings, serve: Serve
) -> None:
    api = serve(settings)
    assert api.client.get("/v1/jobs").status_code == 200
    before = api.client.post("/v1/jobs/contours", json=CONTOUR_REQUEST).json()["id"]
    token = new_key(settings.data_dir, "ours")[1]
    assert api.client.get("/v1/jobs").status_code == 401
    assert api.client.get(f"/v1/jobs/{before}", headers=bearer(token)).status_code == 404
    heir = new_key(settings.data_dir, "anonymous")[1]
    assert api.client.get(f"/v1/jobs/{before}", headers=bearer(heir)).status_code == 200


def test_the_loss_of_redis_loses_no_key(keyed: Api, token: str) -> None:
    with make_redis(keyed.settings.redis_url) as redis:
        redis.flushall()
    assert keyed.client.get("/v1/jobs", headers=bearer(token)).status_code == 200


def test_a_key_file_that_vanishes_opens_no_door(keyed: Api) -> None:
    assert keyed.client.get("/v1/jobs").status_code == 401
    (keyed.settings.data_dir / "keys.json").unlink()
    assert keyed.client.get("/v1/jobs").status_code == 401


def test_a_damaged_key_file_lets_nobody_in(keyed: Api, token: str) -> None:
    (keyed.settings.data_dir / "keys.json").write_text('{"keys": [')
    for headers in ({}, bearer(token)):
        answer = keyed.client.get("/v1/jobs", headers=headers)
        problem_of(answer, 500, ProblemType.INTERNAL)


@pytest.mark.parametrize(("require", "status"), [(True, 401), (False, 200), (None, 200)])
def test_the_setting_decides_while_there_is_no_key(
    settings: ServiceSettings, serve: Serve, require: bool | None, status: int
) -> None:
    api = serve(settings.model_copy(update={"require_keys": require}))
    assert api.client.get("/v1/jobs").status_code == status


def test_keys_that_are_not_required_still_have_to_be_good(
    settings: ServiceSettings, serve: Serve
) -> None:
    api = serve(settings.model_copy(update={"require_keys": False}))
    job_id = submit_as(api, new_key(settings.data_dir, "ours")[1])
    assert api.client.get("/v1/jobs").json()["jobs"] == []
    assert api.client.get(f"/v1/jobs/{job_id}").status_code == 404
    assert api.client.delete(f"/v1/jobs/{job_id}").status_code == 404
    assert api.client.get("/v1/jobs", headers=bearer("nonsense")).status_code == 401
