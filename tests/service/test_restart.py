"""A job done anew: from the inputs that are there, beside the first job and independent of it."""

from pathlib import Path
from typing import Any

import httpx
import pytest

from schemas.job import JobState
from schemas.problem import ProblemType
from schemas.vocabulary import Structure
from service.examples import CONTOUR_REQUEST
from tests.service.conftest import Api
from tests.service.jobs_done import claim, finish
from tests.service.test_jobs import problem_of, submitted
from tests.service.test_submit_labels import GOOD, form
from tests.service.test_submit_references import PLY

ENDED = (JobState.SUCCEEDED, JobState.FAILED, JobState.CANCELLED)


def ended(api: Api, job_id: str, state: JobState = JobState.SUCCEEDED) -> str:
    if state is JobState.CANCELLED:
        assert api.client.post(f"/v1/jobs/{job_id}/cancel").status_code == 200
    else:
        finish(api.store, api.records, job_id, state)
    return job_id


def restarted(api: Api, job_id: str, options: dict[str, Any] | None = None) -> dict[str, Any]:
    body = {} if options is None else {"json": {"options": options}}
    answer = api.client.post(f"/v1/jobs/{job_id}/restart", **body)
    assert answer.status_code == 202, answer.text
    job: dict[str, Any] = answer.json()
    assert answer.headers["location"] == job["links"]["self"]
    assert int(answer.headers["retry-after"]) > 0
    return job


def tree(folder: Path) -> dict[str, bytes]:
    return {
        str(path.relative_to(folder)): path.read_bytes()
        for path in folder.rglob("*")
        if path.is_file()
    }


@pytest.mark.parametrize("state", ENDED)
def test_a_restart_is_a_new_job_and_leaves_the_old_one_alone(api: Api, state: JobState) -> None:
    old = ended(api, submitted(api), state)
    told, stored = api.client.get(f"/v1/jobs/{old}").json(), tree(api.store.folder(old).path)
    job = restarted(api, old, {"seed": 5, "mesh": {"projection_steps": 0}})
    assert job["id"] != old
    assert (job["state"], job["kind"], job["restarted_from"]) == ("queued", "contours", old)
    assert api.client.get(job["links"]["self"]).json() == job
    before, after = (api.store.folder(id_).request() for id_ in (old, job["id"]))
    assert before.contours is not None
    assert after.contours is not None
    assert after.contours.study == before.contours.study
    assert after.contours.options.seed == 5
    # The preset of the first request is "fast".
    assert after.contours.options.mesh.grid_mm == before.contours.options.mesh.grid_mm == 2.0
    assert after.contours.options.mesh.projection_steps == 0
    assert after.created_at > before.created_at
    assert api.client.get(f"/v1/jobs/{old}").json() == told
    assert told["restarted_from"] is None
    assert tree(api.store.folder(old).path) == stored
    claim(api.records, job["id"])


def test_without_a_body_nothing_is_changed(api: Api) -> None:
    old = ended(api, submitted(api))
    job = restarted(api, old)
    before, after = (api.store.folder(id_).request() for id_ in (old, job["id"]))
    assert after.contours == before.contours


def test_a_restart_can_be_restarted_and_redis_may_forget_it(api: Api) -> None:
    first = ended(api, submitted(api))
    second = ended(api, restarted(api, first)["id"])
    third = restarted(api, second)
    assert third["restarted_from"] == second
    api.records.forget(third["id"])
    assert api.client.get(third["links"]["self"]).json()["restarted_from"] == second


@pytest.mark.parametrize("kind", ["contours", "labels"])
@pytest.mark.parametrize("erased", ["old", "new"])
def test_files_are_shared_and_erasing_either_job_leaves_the_other_s(
    api: Api, kind: str, erased: str
) -> None:
    name = "ED_lv_endo" if kind == "contours" else "t00_lv_endo"
    maps = dict(GOOD.files()) if kind == "labels" else {}
    request = dict(GOOD.request) if kind == "labels" else CONTOUR_REQUEST
    parts = form({**maps, f"reference_{name}": PLY}, request)
    answer = api.client.post(f"/v1/jobs/{kind}", files=parts)
    assert answer.status_code == 202, answer.text
    ids = {"old": ended(api, answer.json()["id"])}
    ids["new"] = restarted(api, ids["old"], {"seed": 3})["id"]
    folders = {which: api.store.folder(job_id) for which, job_id in ids.items()}
    before, after = (folders[which].request() for which in ("old", "new"))
    assert (after.files, after.references) == (before.files, before.references)
    inputs = tree(folders["old"].path / "inputs")
    assert set(inputs) == {*before.files.values(), *before.references.values()}
    for file in inputs:
        assert folders["old"].input_path(file).samefile(folders["new"].input_path(file))
    kept = folders["new" if erased == "old" else "old"]
    assert api.client.delete(f"/v1/jobs/{ids[erased]}").status_code == 204
    assert tree(kept.path / "inputs") == inputs


@pytest.mark.parametrize("state", ["queued", "running", "cancelling"])
def test_a_job_that_has_not_ended_is_not_restarted(api: Api, state: str) -> None:
    job_id = submitted(api)
    if state != "queued":
        claim(api.records, job_id)
    if state == "cancelling":
        api.client.post(f"/v1/jobs/{job_id}/cancel")
    answer = api.client.post(f"/v1/jobs/{job_id}/restart")
    problem_of(answer, 409, ProblemType.NOT_READY)
    assert int(answer.headers["retry-after"]) > 0
    assert api.store.ids() == [job_id]


@pytest.mark.parametrize("job_id", ["0" * 32, "nonsense"])
def test_an_unknown_job_is_not_restarted(api: Api, job_id: str) -> None:
    problem_of(api.client.post(f"/v1/jobs/{job_id}/restart"), 404, ProblemType.NOT_FOUND)


def test_an_erased_job_is_not_restarted(api: Api) -> None:
    job_id = ended(api, submitted(api))
    api.client.delete(f"/v1/jobs/{job_id}")
    problem_of(api.client.post(f"/v1/jobs/{job_id}/restart"), 404, ProblemType.NOT_FOUND)
    assert list(api.store.root.iterdir()) == []


@pytest.mark.parametrize(
    ("body", "status", "type_", "pointer"),
    [
        ({"options": {"levels": 99}}, 422, ProblemType.INVALID_REQUEST, "/options/levels"),
        ({"options": {"mesh": 3}}, 422, ProblemType.INVALID_REQUEST, "/options/mesh"),
        ({"options": {"meshes": {}}}, 422, ProblemType.INVALID_REQUEST, "/options/meshes"),
        ({"study": {}}, 422, ProblemType.INVALID_REQUEST, "/study"),
        (
            {"options": {"surfaces": [Structure.RV_ENDO]}},
            422,
            ProblemType.UNSUPPORTED_SURFACE,
            "/options/surfaces/0",
        ),
    ],
)
def test_a_change_is_judged_like_a_request(
    api: Api, body: dict[str, Any], status: int, type_: ProblemType, pointer: str
) -> None:
    job_id = ended(api, submitted(api))
    answer = api.client.post(f"/v1/jobs/{job_id}/restart", json=body)
    assert problem_of(answer, status, type_).pointer == pointer
    assert api.store.ids() == [job_id]


def test_a_reference_of_what_is_no_longer_made_is_refused(api: Api) -> None:
    parts = form({"reference_ED_lv_epi": PLY}, CONTOUR_REQUEST)
    job_id = ended(api, api.client.post("/v1/jobs/contours", files=parts).json()["id"])
    body = {"options": {"surfaces": ["lv_endo"]}}
    answer = api.client.post(f"/v1/jobs/{job_id}/restart", json=body)
    assert problem_of(answer, 422, ProblemType.INVALID_REQUEST).pointer == "reference_ED_lv_epi"


def test_only_json_changes_options(api: Api) -> None:
    job_id = ended(api, submitted(api))
    address = f"/v1/jobs/{job_id}/restart"
    text = api.client.post(address, content="seed=1", headers={"Content-Type": "text/plain"})
    problem_of(text, 415, ProblemType.UNSUPPORTED_MEDIA_TYPE)
    broken = api.client.post(
        address, content='{"options": ', headers={"Content-Type": "application/json"}
    )
    problem_of(broken, 400, ProblemType.MALFORMED_JSON)


def test_one_key_makes_one_restart(api: Api) -> None:
    old = ended(api, submitted(api))

    def asked(key: str, seed: int) -> httpx.Response:
        return api.client.post(
            f"/v1/jobs/{old}/restart",
            json={"options": {"seed": seed}},
            headers={"Idempotency-Key": key, "Prefer": "wait=0"},
        )

    first, again, other = asked("a", 1), asked("a", 1), asked("b", 1)
    assert [answer.status_code for answer in (first, again, other)] == [202, 202, 202]
    assert first.headers["preference-applied"] == "wait=0"
    assert again.headers["idempotency-replayed"] == "true"
    assert first.json()["id"] == again.json()["id"] != other.json()["id"]
    assert asked("a", 2).json()["type"].endswith("idempotency-key-reused")
