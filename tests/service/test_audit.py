"""What the audit log says of requests, and what it never says."""

import json
import logging
import shutil
from collections.abc import Iterator
from pathlib import Path
from typing import Any

import httpx
import pytest

from schemas.api_key import Scope
from schemas.job import JobState
from service.examples import CONTOUR_REQUEST
from service.settings import ServiceSettings
from tests.service.callers import Serve, bearer, new_key, submit_as
from tests.service.conftest import Api
from tests.service.jobs_done import finish
from tests.service.test_events import wait_until

SUBJECT = "Doe.Jane-1961"

_OF_THE_CALLER = ("httpx", "httpcore")
"""Loggers of the client in this process: what it asked for is no secret to itself."""


def lines(api: Api, name: str) -> list[dict[str, Any]]:
    path = api.settings.data_dir / "audit" / f"{name}.jsonl"
    return [json.loads(line) for line in path.read_text().splitlines()] if path.exists() else []


def said(entry: dict[str, Any]) -> tuple[Any, ...]:
    return tuple(entry.get(name) for name in ("actor", "owner", "action", "job", "status"))


def test_who_did_what_to_which_job(keyed: Api) -> None:
    key_id, token = new_key(keyed.settings.data_dir, "ours")
    mine = bearer(token)
    job_id = submit_as(keyed, token)
    finish(keyed.store, keyed.records, job_id, JobState.SUCCEEDED)
    here = f"/v1/jobs/{job_id}"
    keyed.client.get(here, headers=mine)
    keyed.client.get("/v1/jobs", headers=mine)
    keyed.client.get(f"{here}/artifacts", headers=mine)
    etag = keyed.client.get(f"{here}/artifacts/ED_lv_endo.stl", headers=mine).headers["etag"]
    again = {**mine, "If-None-Match": etag}
    assert keyed.client.get(f"{here}/artifacts/ED_lv_endo.stl", headers=again).status_code == 304
    keyed.client.get(f"{here}/report", headers=mine)
    keyed.client.get(f"{here}/request", headers=mine)
    keyed.client.post(f"{here}/cancel", headers=mine)
    keyed.client.delete(here, headers=mine)
    assert [said(entry) for entry in lines(keyed, "done")] == [
        (key_id, "ours", "submit", job_id, 202),
        (key_id, "ours", "download", job_id, 200),
        (key_id, "ours", "download", job_id, 200),
        (key_id, "ours", "download", job_id, 200),
        (key_id, "ours", "cancel", job_id, 200),
        (key_id, "ours", "erase", job_id, 204),
    ]
    assert lines(keyed, "refused") == []


def test_what_was_refused_stands_apart(keyed: Api) -> None:
    data_dir = keyed.settings.data_dir
    job_id = submit_as(keyed, new_key(data_dir, "ours")[1])
    reader_id, reader = new_key(data_dir, "theirs", Scope.READ)
    here = f"/v1/jobs/{job_id}"
    keyed.client.get("/v1/jobs")
    keyed.client.get(here, headers=bearer(reader))
    keyed.client.delete(here, headers=bearer(reader))
    keyed.client.get("/v1/jobs/no-id-but-words", headers=bearer(reader))
    assert [said(entry) for entry in lines(keyed, "refused")] == [
        ("unknown", None, "read", None, 401),
        (reader_id, "theirs", "read", job_id, 404),
        (reader_id, None, "erase", job_id, 403),
        (reader_id, "theirs", "read", None, 404),
    ]
    assert {entry["outcome"] for entry in lines(keyed, "refused")} == {"refused"}
    assert len(lines(keyed, "done")) == 1


def test_a_request_that_fails_is_no_deed(keyed: Api) -> None:
    mine = bearer(new_key(keyed.settings.data_dir, "ours")[1])
    assert keyed.client.post("/v1/jobs/contours", json={}, headers=mine).status_code == 422
    (entry,) = lines(keyed, "refused")
    assert (entry["action"], entry["outcome"], entry["status"]) == ("submit", "failed", 422)
    assert lines(keyed, "done") == []


def test_without_keys_everybody_is_anonymous(settings: ServiceSettings, serve: Serve) -> None:
    api = serve(settings)
    job_id = api.client.post("/v1/jobs/contours", json=CONTOUR_REQUEST).json()["id"]
    assert said(lines(api, "done")[0]) == ("anonymous", "anonymous", "submit", job_id, 202)


@pytest.fixture
def all_logs(caplog: pytest.LogCaptureFixture) -> Iterator[pytest.LogCaptureFixture]:
    with caplog.at_level(logging.DEBUG):
        yield caplog


def test_no_subject_and_no_secret_in_logs_audit_or_metrics(
    keyed: Api, all_logs: pytest.LogCaptureFixture
) -> None:
    """A whole life of a job, mishaps included; then every place where words are left is read."""
    data_dir = keyed.settings.data_dir
    token = new_key(data_dir, "ours", Scope.ADMIN)[1]
    mine = bearer(token)
    study = {**CONTOUR_REQUEST["study"], "subject_id": SUBJECT}
    body = {**CONTOUR_REQUEST, "study": study}
    job_id = keyed.client.post("/v1/jobs/contours", json=body, headers=mine).json()["id"]
    assert SUBJECT in (keyed.store.folder(job_id).path / "request.json").read_text()
    finish(keyed.store, keyed.records, job_id, JobState.SUCCEEDED)
    keyed.client.post("/v1/jobs/contours", json={**body, "options": {"x": SUBJECT}}, headers=mine)
    keyed.client.post("/v1/jobs/contours", json=body, headers=bearer(token[:-1]))
    for path in (SUBJECT, f"{job_id}/artifacts/{SUBJECT}.stl", f"{SUBJECT}/report", job_id):
        keyed.client.get(f"/v1/jobs/{path}", headers=mine)
    keyed.client.get(f"/{SUBJECT}", params={"subject": SUBJECT}, headers=mine)
    shutil.rmtree(keyed.store.folder(job_id).path / "results")
    assert keyed.client.get(f"/v1/jobs/{job_id}/report", headers=mine).status_code == 500
    metrics = keyed.client.get("/metrics", headers=mine).text
    keyed.client.delete(f"/v1/jobs/{job_id}", headers=mine)
    left = [path for path in data_dir.rglob("*") if path.is_file()]
    assert {"keys.json", "keys-used.json", "done.jsonl", "refused.jsonl"} <= {p.name for p in left}
    whole = logging.Formatter()  # with tracebacks
    own = [whole.format(r) for r in all_logs.records if not r.name.startswith(_OF_THE_CALLER)]
    words = "\n".join([*own, metrics, *(path.read_text() for path in left)])
    assert job_id in words
    assert SUBJECT not in words
    assert token[-64:] not in words
    assert token[-64:-1] not in words


def test_a_log_that_cannot_be_written_costs_no_request_and_no_line(
    keyed: Api, all_logs: pytest.LogCaptureFixture
) -> None:
    audit = keyed.settings.data_dir / "audit"
    shutil.rmtree(audit, ignore_errors=True)
    audit.touch()
    key_id, token = new_key(keyed.settings.data_dir, "ours")
    job_id = submit_as(keyed, token)
    record = next(r for r in all_logs.records if r.name == "neuralmri.audit")
    assert record.levelno == logging.ERROR
    assert key_id in record.getMessage()
    assert job_id in record.getMessage()


def test_files_are_private(keyed: Api) -> None:
    submit_as(keyed, new_key(keyed.settings.data_dir, "ours")[1])
    data_dir: Path = keyed.settings.data_dir
    made = [p for p in data_dir.rglob("*") if "jobs" not in p.parts and p.is_file()]
    assert {oct(path.stat().st_mode & 0o777) for path in made} == {"0o600"}


def test_a_restart_is_told_of_by_the_job_that_it_made_whoever_asks(keyed: Api) -> None:
    """An operator does a caller's job anew: it stays the caller's."""
    _, token = new_key(keyed.settings.data_dir, "ours")
    admin_id, admin = new_key(keyed.settings.data_dir, "operators", Scope.ADMIN)
    old = submit_as(keyed, token)
    finish(keyed.store, keyed.records, old, JobState.SUCCEEDED)
    made = keyed.client.post(f"/v1/jobs/{old}/restart", headers=bearer(admin)).json()["id"]
    assert said(lines(keyed, "done")[-1]) == (admin_id, "operators", "submit", made, 202)
    assert keyed.client.get(f"/v1/jobs/{made}", headers=bearer(token)).status_code == 200
    assert keyed.store.folder(made).owner() == "ours"


def test_who_hangs_up_while_the_answer_is_held_has_submitted_all_the_same(api: Api) -> None:
    with pytest.raises(httpx.ReadTimeout):
        api.client.post(
            "/v1/jobs/contours",
            json=CONTOUR_REQUEST,
            headers={"Prefer": "wait=30"},
            timeout=httpx.Timeout(10.0, read=1.0),
        )
    (job_id,) = api.records.ids()

    def told() -> list[tuple[Any, ...]]:
        return [said(entry)[2:] for entry in lines(api, "done") if entry.get("job") == job_id]

    wait_until(lambda: bool(told()))
    assert told() == [("submit", job_id, 202)]
