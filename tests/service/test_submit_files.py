"""Contour files of other programs, sent as they are: a contour job from the door on."""

import json
from typing import Any

import httpx
import pytest

from intake.formats.guide_points import read_guide_points
from schemas.job import JobKind
from schemas.problem import ProblemType
from tests.intake.formats.guide_point_files import heart
from tests.service.conftest import Api
from tests.service.test_jobs import problem_of

REQUEST = {"subject_id": "case-01", "options": {"preset": "fast"}}


def form(files: dict[str, bytes], request: Any = REQUEST) -> list[tuple[str, Any]]:
    parts: list[tuple[str, Any]] = [("request", (None, json.dumps(request)))]
    return parts + [("file", (name, content)) for name, content in files.items()]


def sent(api: Api, parts: Any, **headers: str) -> httpx.Response:
    return api.client.post("/v1/jobs/files", files=parts, headers=headers)


def test_files_make_a_contour_job_and_their_study_is_given_back(api: Api) -> None:
    answer = sent(api, form(heart()))
    assert answer.status_code == 202, answer.text
    job = answer.json()
    stored = api.store.folder(job["id"]).request()
    imported = read_guide_points(heart(), subject_id="case-01")
    assert stored.kind is JobKind.CONTOURS
    assert stored.contours is not None
    assert stored.contours.study == imported.study
    assert stored.contours.warnings == list(imported.warnings) != []
    given = api.client.get(f"/v1/jobs/{job['id']}/request").json()
    again = api.client.post("/v1/jobs/contours", json=given)
    assert again.status_code == 202, again.text


def test_names_of_files_are_no_paths(api: Api) -> None:
    files = {f"../../../tmp/{name}": body for name, body in heart().items()}
    answer = sent(api, form(files))
    assert answer.status_code == 202, answer.text
    stored = api.store.folder(answer.json()["id"]).request()
    assert stored.contours is not None
    assert [frame.label for frame in stored.contours.study.frames] == ["t000"]


def test_one_key_makes_one_job(api: Api) -> None:
    key = {"Idempotency-Key": "one"}
    first, second = (sent(api, form(heart()), **key) for _ in range(2))
    assert first.json()["id"] == second.json()["id"]
    renamed = {name.replace("000", "001"): body for name, body in heart().items()}
    problem_of(sent(api, form(renamed), **key), 422, ProblemType.IDEMPOTENCY_KEY_REUSED)


def test_priority_and_format_settings_are_taken(api: Api) -> None:
    request = {**REQUEST, "format": "guide_points", "guide_points": {"views": {"4": "lax_4ch"}}}
    answer = api.client.post("/v1/jobs/files?priority=batch", files=form(heart(), request))
    assert answer.status_code == 202, answer.text
    stored = api.store.folder(answer.json()["id"]).request()
    assert stored.priority == "batch"
    assert stored.contours is not None
    assert stored.contours.study.frames[0].slices[-1].view == "lax_4ch"


BAD = heart() | {"GPFile_000.txt": heart()["GPFile_000.txt"].replace(b"SAX_LV_END", b"?", 1)}


@pytest.mark.parametrize(
    ("parts", "status", "type_", "words"),
    [
        (form({}), 422, ProblemType.INVALID_REQUEST, "no contour file"),
        (form(BAD), 422, ProblemType.UNREADABLE_CONTOUR_FILE, "`GPFile_000.txt`, line 2"),
        (form({"a.bin": b"\0\1"}), 422, ProblemType.UNREADABLE_CONTOUR_FILE, "`a.bin`"),
        (form({"a.txt": b""}), 422, ProblemType.UNREADABLE_CONTOUR_FILE, "`a.txt`"),
        (
            form(heart() | {"ED_lv_endo.csl": b"CSLC\n"}),
            422,
            ProblemType.UNREADABLE_CONTOUR_FILE,
            "several formats",
        ),
        (
            form(heart(), {"format": "csl"}),
            422,
            ProblemType.UNREADABLE_CONTOUR_FILE,
            "first line is not CSLC",
        ),
        (form(heart(), {"format": "dicom"}), 422, ProblemType.INVALID_REQUEST, "/format"),
        (form(heart()) + form(heart())[1:2], 422, ProblemType.INVALID_REQUEST, "more than once"),
        ([*form(heart()), ("sax", ("s", b"x"))], 422, ProblemType.INVALID_REQUEST, "`sax`"),
        ([*form({}), ("file", (None, "x"))], 422, ProblemType.INVALID_REQUEST, "filename"),
        (form({f"{k}.txt": b"x" for k in range(520)}), 413, ProblemType.TOO_LARGE, "520 files"),
    ],
)
def test_what_is_wrong_is_named(
    api: Api, parts: Any, status: int, type_: ProblemType, words: str
) -> None:
    submitted = sent(api, parts)
    assert words in problem_of(submitted, status, type_).detail
    judged = api.client.post("/v1/validate/files", files=parts)
    assert words in problem_of(judged, status, type_).detail
    assert list(api.store.root.iterdir()) == []


def test_validating_says_what_was_guessed_and_keeps_nothing(api: Api) -> None:
    answer = api.client.post("/v1/validate/files", files=form(heart()))
    assert answer.status_code == 200, answer.text
    said = answer.json()
    assert said["surfaces"] == {"t000": ["lv_endo", "lv_epi", "rv_endo"]}
    assert said["warnings"] == list(read_guide_points(heart()).warnings)
    assert list(api.store.root.iterdir()) == []
