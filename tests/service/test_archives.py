"""Results of a job, and of a batch, in one archive."""

import hashlib
import io
import json
import zipfile
from typing import Any

import pytest

from schemas.artifacts import MANIFEST_NAME
from schemas.job import JobState
from schemas.problem import ProblemType
from service.examples import CONTOUR_REQUEST
from service.job_archive import archive_folders
from tests.service.conftest import Api
from tests.service.jobs_done import FILES, finish
from tests.service.test_batches import accepted, job_ids, named, no_batches, now, post
from tests.service.test_jobs import problem_of, submitted

__all__ = ["no_batches"]

ALL = {*FILES, MANIFEST_NAME}


def unzipped(answer: Any, name: str) -> dict[str, bytes]:
    assert answer.status_code == 200, answer.text
    assert answer.headers["content-type"] == "application/zip"
    assert answer.headers["content-disposition"] == f'attachment; filename="{name}.zip"'
    with zipfile.ZipFile(io.BytesIO(answer.content)) as archive:
        assert archive.testzip() is None
        assert len(set(archive.namelist())) == len(archive.namelist())
        assert {info.compress_type for info in archive.infolist()} == {zipfile.ZIP_STORED}
        return {name: archive.read(name) for name in archive.namelist()}


def test_every_artifact_of_a_job_and_its_manifest(api: Api) -> None:
    job_id = submitted(api)
    here = f"/v1/jobs/{job_id}"
    early = api.client.get(f"{here}/artifacts.zip")
    problem_of(early, 409, ProblemType.NOT_READY)
    assert int(early.headers["retry-after"]) >= 1
    finish(api.store, api.records, job_id, JobState.SUCCEEDED)
    files = unzipped(api.client.get(f"{here}/artifacts.zip"), job_id)
    listed = api.client.get(f"{here}/artifacts").json()["artifacts"]
    assert set(files) == ALL
    for artifact in listed:
        assert hashlib.sha256(files[artifact["name"]]).hexdigest() == artifact["sha256"]
    assert files[MANIFEST_NAME] == api.client.get(f"{here}/artifacts/{MANIFEST_NAME}").content


def test_only_what_a_pattern_fits(api: Api) -> None:
    job_id = submitted(api)
    finish(api.store, api.records, job_id, JobState.SUCCEEDED)
    here = f"/v1/jobs/{job_id}/artifacts.zip"
    for query, names in (
        ("artifact=*.stl", {"ED_lv_endo.stl"}),
        ("artifact=report.*", {"report.json", "report.html"}),
        ("artifact=report.json&artifact=E?_*", {"report.json", "ED_lv_endo.stl"}),
        ("artifact=*", ALL),
    ):
        assert set(unzipped(api.client.get(f"{here}?{query}"), job_id)) == names
    nothing = problem_of(api.client.get(f"{here}?artifact=*.ply"), 404, ProblemType.NOT_FOUND)
    assert nothing.pointer == "/query/artifact"
    for pattern in ("../*", "[a-z]*", "a" * 161, ""):
        answer = api.client.get(here, params={"artifact": pattern})
        problem_of(answer, 422, ProblemType.INVALID_REQUEST)


def test_a_batch_has_a_folder_for_each_job(api: Api) -> None:
    batch = accepted(post(api, [*named("a", "b", "A"), {"study": CONTOUR_REQUEST["study"]}, {}]))
    first, second, third, fourth = job_ids(batch)
    for job_id in (first, third, fourth):
        finish(api.store, api.records, job_id, JobState.SUCCEEDED)
    here = batch["links"]["archive"]
    early = api.client.get(here)
    problem_of(early, 409, ProblemType.NOT_READY)
    assert int(early.headers["retry-after"]) >= 1
    finish(api.store, api.records, second, JobState.FAILED)
    files = unzipped(api.client.get(here), batch["id"])
    folders = ("a", f"A-{third}", fourth)
    assert set(files) == {"batch.json", *(f"{f}/{name}" for f in folders for name in ALL)}
    assert files["a/ED_lv_endo.stl"] == FILES["ED_lv_endo.stl"][0]
    overview = json.loads(files["batch.json"])
    assert overview["studies"] == now(api, batch)["studies"]
    some = unzipped(api.client.get(f"{here}?artifact=*.stl"), batch["id"])
    assert set(some) == {"batch.json", *(f"{f}/ED_lv_endo.stl" for f in folders)}
    problem_of(api.client.get(f"{here}?artifact=x"), 404, ProblemType.NOT_FOUND)


def test_a_batch_without_a_success_has_no_archive(api: Api) -> None:
    batch = accepted(post(api, named("a")))
    api.client.post(batch["links"]["cancel"])
    answer = api.client.get(batch["links"]["archive"])
    problem_of(answer, 409, ProblemType.NOT_READY)
    assert "retry-after" not in answer.headers


@pytest.mark.parametrize("name", ["..", ".", "a/b", "/etc", "-rf", ".ssh", "é", "", "x" * 65])
def test_a_name_that_is_no_folders_is_refused(api: Api, name: str) -> None:
    answer = post(api, [*named(name), *named("good")])
    batch = accepted(answer)
    assert [m["state"] for m in batch["studies"]] == ["refused", "queued"]
    assert batch["studies"][0]["error"]["pointer"] == "/studies/0/name"
    joining = api.client.post(
        f"/v1/jobs/contours?batch={batch['id']}", params={"name": name}, json=CONTOUR_REQUEST
    )
    assert joining.status_code == 422 or name == ""


def test_folders_are_told_apart() -> None:
    one, two, three = (f"{number:032x}" for number in range(3))
    assert archive_folders([(one, "a"), (two, "A"), (three, None)]) == {
        one: "a",
        two: f"A-{two}",
        three: three,
    }
    # Names that look like what others would be called.
    assert archive_folders([(one, f"a-{three}"), (two, "a"), (three, "a")])[three] == three
    assert archive_folders([(one, "../x")]) == {one: one}
