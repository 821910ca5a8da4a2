import gzip
import json
from typing import Any

import pytest

from schemas.problem import ProblemType
from schemas.vocabulary import View
from tests.labelmaps.catalogue import CATALOGUE, LabelMapCase
from tests.service.conftest import Api
from tests.service.test_jobs import problem_of

REQUEST = {"subject_id": "case-01", "label_scheme": "mnms", "options": {"preset": "fast"}}
GOOD = next(case for case in CATALOGUE if case.where == "accepted")


def form(files: dict[str, bytes], request: Any = REQUEST) -> list[tuple[str, Any]]:
    """Parts of a submission; the clients' names of the files are hostile."""
    parts: list[tuple[str, Any]] = [("request", (None, json.dumps(request)))]
    parts += [(name, ("../../etc/passwd", content)) for name, content in files.items()]
    return parts


@pytest.mark.parametrize(
    "case", [c for c in CATALOGUE if c.where == "door"], ids=lambda case: case.name
)
def test_what_the_headers_tell_is_told_at_the_door(api: Api, case: LabelMapCase) -> None:
    assert case.problem is not None
    answer = api.client.post("/v1/jobs/labels", files=form(dict(case.files()), dict(case.request)))
    problem = problem_of(answer, case.status, case.problem)
    assert problem.pointer == case.pointer
    assert list(api.store.root.iterdir()) == []


@pytest.mark.parametrize(
    "case", [c for c in CATALOGUE if c.where != "door"], ids=lambda case: case.name
)
def test_what_takes_the_voxels_is_accepted(api: Api, case: LabelMapCase) -> None:
    files = dict(case.files())
    answer = api.client.post("/v1/jobs/labels", files=form(files, dict(case.request)))
    assert answer.status_code == 202, answer.text
    folder = api.store.folder(answer.json()["id"])
    stored = folder.request()
    assert stored.labels is not None
    assert {view.value for view in stored.files} == set(files)
    for view, name in stored.files.items():
        assert folder.input_path(name).read_bytes() == files[view.value]


def test_files_are_named_by_their_content(api: Api) -> None:
    content = GOOD.files()["sax"]
    plain = gzip.decompress(content) if content[:2] == b"\x1f\x8b" else content
    for sent, name in ((plain, "sax.nii"), (gzip.compress(plain), "sax.nii.gz")):
        answer = api.client.post("/v1/jobs/labels", files=form({"sax": sent}, dict(GOOD.request)))
        assert answer.status_code == 202, answer.text
        folder = api.store.folder(answer.json()["id"])
        assert folder.request().files == {View.SAX: name}
        assert [p.name for p in (folder.path / "inputs").iterdir()] == [name]


def test_the_json_part_may_be_a_file(api: Api) -> None:
    parts = form({"sax": GOOD.files()["sax"]}, dict(GOOD.request))
    text = parts[0][1][1]
    parts[0] = ("request", ("request.json", text, "application/json"))
    assert api.client.post("/v1/jobs/labels", files=parts).status_code == 202


@pytest.mark.parametrize(
    ("parts", "status", "type_", "pointer"),
    [
        ([("sax", ("a", b"x"))], 422, ProblemType.INVALID_REQUEST, "request"),
        (form({}), 422, ProblemType.INVALID_REQUEST, "sax"),
        (form({"axial": b"x"}), 422, ProblemType.INVALID_REQUEST, "axial"),
        (form({"other": b"x"}), 422, ProblemType.INVALID_REQUEST, "other"),
        (form({"sax": b"x"}) * 2, 422, ProblemType.INVALID_REQUEST, "request"),
        ([*form({}), ("sax", (None, "x"))], 422, ProblemType.INVALID_REQUEST, "sax"),
        (
            [("request", ("r.json", b" " * 2_000_000)), ("sax", ("a", b"x"))],
            413,
            ProblemType.TOO_LARGE,
            "request",
        ),
        ([*form({"sax": b"x"}), ("sax", ("b", b"y"))], 422, ProblemType.INVALID_REQUEST, "sax"),
        (
            form({"sax": b"x"}, {"subject_id": "a"}),
            422,
            ProblemType.INVALID_REQUEST,
            "/label_scheme",
        ),
        ([("request", (None, "{"))], 400, ProblemType.MALFORMED_JSON, None),
        (
            [("request", (None, b"\xff")), ("sax", ("a", b"x"))],
            400,
            ProblemType.MALFORMED_JSON,
            None,
        ),
    ],
)
def test_a_bad_form_is_named(
    api: Api, parts: Any, status: int, type_: ProblemType, pointer: str | None
) -> None:
    answer = api.client.post("/v1/jobs/labels", files=parts)
    assert problem_of(answer, status, type_).pointer == pointer
    assert list(api.store.root.iterdir()) == []


def test_only_a_form_is_taken(api: Api) -> None:
    answer = api.client.post("/v1/jobs/labels", json=REQUEST)
    problem_of(answer, 415, ProblemType.UNSUPPORTED_MEDIA_TYPE)


@pytest.mark.parametrize(
    "headers",
    [
        {"Content-Type": "multipart/form-data"},
        {"Content-Type": "multipart/form-data; boundary=b"},
    ],
)
def test_a_broken_form_is_a_problem(api: Api, headers: dict[str, str]) -> None:
    answer = api.client.post("/v1/jobs/labels", content=b"no form at all", headers=headers)
    problem_of(answer, 400, ProblemType.INVALID_REQUEST)
