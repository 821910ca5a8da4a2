import hashlib

import pytest

from schemas.job import JobState
from schemas.problem import ProblemType
from tests.service.conftest import Api
from tests.service.jobs_done import FILES, MESH, finish
from tests.service.test_jobs import problem_of, submitted


@pytest.fixture
def api(any_api: Api) -> Api:
    return any_api


@pytest.fixture
def job_id(api: Api) -> str:
    job_id = submitted(api)
    finish(api.store, api.records, job_id, JobState.SUCCEEDED)
    return job_id


def test_every_listed_file_is_what_its_hash_says(api: Api, job_id: str) -> None:
    listed = api.client.get(f"/v1/jobs/{job_id}/artifacts").json()["artifacts"]
    assert {artifact["name"] for artifact in listed} == set(FILES)
    for artifact in listed:
        answer = api.client.get(f"/v1/jobs/{job_id}/artifacts/{artifact['name']}")
        assert answer.status_code == 200
        assert hashlib.sha256(answer.content).hexdigest() == artifact["sha256"]
        assert len(answer.content) == artifact["bytes"] == int(answer.headers["content-length"])
        assert answer.headers["content-type"] == artifact["media_type"]
        assert answer.headers["etag"] == f'"{artifact["sha256"]}"'
        assert answer.headers["x-content-type-options"] == "nosniff"
        assert f'filename="{artifact["name"]}"' in answer.headers["content-disposition"]


def test_a_file_that_the_caller_has_is_not_sent(api: Api, job_id: str) -> None:
    address = f"/v1/jobs/{job_id}/artifacts/ED_lv_endo.stl"
    etag = api.client.get(address).headers["etag"]
    for header in (etag, f'"other", W/{etag}', "*"):
        answer = api.client.get(address, headers={"If-None-Match": header})
        assert (answer.status_code, answer.content) == (304, b"")
        assert answer.headers["etag"] == etag
    assert api.client.get(address, headers={"If-None-Match": '"other"'}).status_code == 200


@pytest.mark.parametrize(
    ("asked", "first", "last"),
    [
        ("0-0", 0, 0),
        ("100-199", 100, 199),
        ("10000-", 10000, 10239),
        ("-5", 10235, 10239),
        ("0-999999", 0, 10239),
    ],
)
def test_ranges(api: Api, job_id: str, asked: str, first: int, last: int) -> None:
    answer = api.client.get(
        f"/v1/jobs/{job_id}/artifacts/ED_lv_endo.stl", headers={"Range": f"bytes={asked}"}
    )
    assert answer.status_code == 206
    assert answer.content == MESH[first : last + 1]
    assert answer.headers["content-range"] == f"bytes {first}-{last}/{len(MESH)}"


def test_several_ranges_are_one_answer(api: Api, job_id: str) -> None:
    answer = api.client.get(
        f"/v1/jobs/{job_id}/artifacts/ED_lv_endo.stl", headers={"Range": "bytes=0-9,5000-5009"}
    )
    assert answer.status_code == 206
    assert answer.headers["content-type"].startswith("multipart/byteranges")
    assert len(answer.content) == int(answer.headers["content-length"])
    for start in (0, 5000):
        said = f"content-range: bytes {start}-{start + 9}/{len(MESH)}\r\n\r\n".encode()
        _, _, after = answer.content.lower().partition(said)
        assert after[:10] == MESH[start : start + 10].lower()


def test_a_range_past_the_end(api: Api, job_id: str) -> None:
    answer = api.client.get(
        f"/v1/jobs/{job_id}/artifacts/ED_lv_endo.stl", headers={"Range": "bytes=20000-"}
    )
    problem_of(answer, 416, ProblemType.UNSATISFIABLE_RANGE)
    assert answer.headers["content-range"] == f"bytes */{len(MESH)}"


def test_a_range_of_a_file_that_changed_is_the_whole(api: Api, job_id: str) -> None:
    answer = api.client.get(
        f"/v1/jobs/{job_id}/artifacts/ED_lv_endo.stl",
        headers={"Range": "bytes=0-9", "If-Range": '"another"'},
    )
    assert (answer.status_code, answer.content) == (200, MESH)


def test_head_is_get_without_the_bytes(api: Api, job_id: str) -> None:
    address = f"/v1/jobs/{job_id}/artifacts/ED_lv_endo.stl"
    head, whole = api.client.head(address), api.client.get(address)
    assert (head.status_code, head.content) == (200, b"")
    for name in ("content-length", "etag", "content-type"):
        assert head.headers[name] == whole.headers[name]


def test_the_report(api: Api, job_id: str) -> None:
    answer = api.client.get(f"/v1/jobs/{job_id}/report")
    assert answer.content == FILES["report.json"][0]
    assert answer.headers["content-type"] == "application/json"


def test_the_manifest_is_an_artifact_too(api: Api, job_id: str) -> None:
    answer = api.client.get(f"/v1/jobs/{job_id}/artifacts/manifest.json")
    assert answer.json() == api.client.get(f"/v1/jobs/{job_id}/artifacts").json()


def test_a_report_can_do_no_harm(api: Api, job_id: str) -> None:
    answer = api.client.get(f"/v1/jobs/{job_id}/artifacts/report.html")
    policy = answer.headers["content-security-policy"]
    granted = {name: rest for name, *rest in (part.split() for part in policy.split(";"))}
    assert granted == {
        # Without allow-same-origin its script cannot act as the caller does.
        "sandbox": ["allow-scripts", "allow-downloads"],
        "default-src": ["'none'"],
        "style-src": ["'unsafe-inline'"],
        "script-src": ["'unsafe-inline'"],
        "img-src": ["data:", "blob:"],
    }


@pytest.mark.parametrize("name", ["nothing.stl", "..%2frequest.json", "request.json", "%00"])
def test_only_artifacts_are_served(api: Api, job_id: str, name: str) -> None:
    answer = api.client.get(f"/v1/jobs/{job_id}/artifacts/{name}")
    problem_of(answer, 404, ProblemType.NOT_FOUND)


@pytest.mark.parametrize("path", ["report", "artifacts", "artifacts/ED_lv_endo.stl"])
def test_results_before_the_end(api: Api, path: str) -> None:
    job_id = submitted(api)
    answer = api.client.get(f"/v1/jobs/{job_id}/{path}")
    problem_of(answer, 409, ProblemType.NOT_READY)
    assert int(answer.headers["retry-after"]) > 0
    finish(api.store, api.records, job_id, JobState.FAILED)
    answer = api.client.get(f"/v1/jobs/{job_id}/{path}")
    assert "failed" in problem_of(answer, 409, ProblemType.NOT_READY).detail
    assert "retry-after" not in answer.headers
