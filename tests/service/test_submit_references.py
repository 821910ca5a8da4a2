"""Reference meshes beside a study or label maps: named, judged, and stored with the job."""

import json
from collections.abc import Callable
from pathlib import Path
from typing import Any

import httpx
import pytest
import trimesh

from cli.client import Client
from cli.inputs import ContourInput, LabelInput
from schemas.labels import LabelRequest
from schemas.messages import ContourRequest
from schemas.problem import ProblemType
from schemas.vocabulary import View
from service.settings import ServiceSettings
from tests.service.conftest import Api
from tests.service.test_jobs import problem_of
from tests.service.test_submit_labels import GOOD, form
from tests.studies.ellipsoid import good_request

BALL = trimesh.creation.icosphere(subdivisions=2, radius=20.0)
STL: bytes = BALL.export(file_type="stl")
PLY: bytes = BALL.export(file_type="ply")

CONTOURS, LABELS = "/v1/jobs/contours", "/v1/jobs/labels"


def contours(files: dict[str, bytes], request: Any = None) -> list[tuple[str, Any]]:
    return form(files, request or good_request())


def labels(files: dict[str, bytes]) -> list[tuple[str, Any]]:
    return form({**GOOD.files(), **files}, dict(GOOD.request))


both = pytest.mark.parametrize(("address", "parts"), [(CONTOURS, contours), (LABELS, labels)])


def stored_references(api: Api, answer: httpx.Response) -> dict[str, bytes]:
    """What a job knows of its references: by surface the bytes in its inputs."""
    assert answer.status_code == 202, answer.text
    folder = api.store.folder(answer.json()["id"])
    return {
        surface: folder.input_path(name).read_bytes()
        for surface, name in folder.request().references.items()
    }


@both
def test_references_are_stored_with_the_job(
    api: Api, address: str, parts: Callable[..., Any]
) -> None:
    sent = parts({"reference_ED_lv_endo": STL, "reference_ED_lv_epi": PLY})
    answer = api.client.post(address, files=sent)
    assert stored_references(api, answer) == {"ED_lv_endo": STL, "ED_lv_epi": PLY}
    inputs = api.store.folder(answer.json()["id"]).path / "inputs"
    assert {"reference_ED_lv_endo.stl", "reference_ED_lv_epi.ply"} <= {
        path.name for path in inputs.iterdir()
    }


def test_the_command_line_sends_them_so(api: Api, tmp_path: Path) -> None:
    truth = tmp_path / "truth.ply"
    truth.write_bytes(PLY)
    files = {}
    for view, content in GOOD.files().items():
        files[View(view)] = tmp_path / view
        files[View(view)].write_bytes(content)
    study = ContourRequest.model_validate(good_request())
    maps = LabelRequest.model_validate(dict(GOOD.request))
    references = {"ED_lv_endo": truth}
    with Client(str(api.client.base_url)) as client:
        for given in (
            ContourInput(study, "/study", references),
            LabelInput(maps, files, references),
        ):
            folder = api.store.folder(client.submit(given).id)
            (name,) = folder.request().references.values()
            assert folder.input_path(name).read_bytes() == PLY


def test_a_form_without_references_is_the_json_alone(api: Api) -> None:
    as_form = api.client.post(CONTOURS, files=contours({}))
    as_json = api.client.post(CONTOURS, json=good_request())
    assert stored_references(api, as_form) == stored_references(api, as_json) == {}
    one, other = (
        api.store.folder(answer.json()["id"]).request().contours for answer in (as_form, as_json)
    )
    assert one == other == ContourRequest.model_validate(good_request())


def test_the_study_may_be_a_file_and_large(api: Api) -> None:
    text = json.dumps(good_request()) + " " * 2_000_000
    for part in ((None, text), ("study.json", text, "application/json")):
        parts = [("request", part), ("reference_ED_lv_endo", ("a", STL))]
        answer = api.client.post(CONTOURS, files=parts)
        assert stored_references(api, answer) == {"ED_lv_endo": STL}


@both
@pytest.mark.parametrize(
    ("files", "status", "type_", "pointer", "said"),
    [
        (
            {"reference_ED_la": STL},
            422,
            ProblemType.INVALID_REQUEST,
            "reference_ED_la",
            "rv_epi, epi",
        ),
        ({"ED_lv_endo": STL}, 422, ProblemType.INVALID_REQUEST, "ED_lv_endo", "reference_ED_lv"),
        ({"reference_": STL}, 422, ProblemType.INVALID_REQUEST, "reference_", "names no surface"),
        (
            {"reference_ED_lv_endo": b""},
            422,
            ProblemType.INVALID_REQUEST,
            "reference_ED_lv_endo",
            "is empty",
        ),
        (
            {"reference_ED_lv_endo": STL, "reference_ED_lv_epi": STL[:-1]},
            422,
            ProblemType.INVALID_REQUEST,
            "reference_ED_lv_epi",
            "cut short",
        ),
        (
            {"reference_ED_lv_endo": b"a letter"},
            422,
            ProblemType.INVALID_REQUEST,
            "reference_ED_lv_endo",
            "convert it",
        ),
        (
            {f"reference_t{k}_lv_endo": STL for k in range(65)},
            422,
            ProblemType.INVALID_REQUEST,
            "reference_t64_lv_endo",
            "one more than 64 references",
        ),
        (
            {f"reference_t{k}_lv_endo": b"" for k in range(200)},
            400,
            ProblemType.INVALID_REQUEST,
            None,
            "Too many files",
        ),
    ],
)
def test_a_bad_reference_is_named(
    api: Api,
    address: str,
    parts: Callable[..., Any],
    files: dict[str, bytes],
    status: int,
    type_: ProblemType,
    pointer: str | None,
    said: str,
) -> None:
    problem = problem_of(api.client.post(address, files=parts(files)), status, type_)
    assert problem.pointer == pointer
    assert said in problem.detail
    assert "Remedy" in problem.detail
    assert list(api.store.root.iterdir()) == []


@both
def test_a_reference_is_sent_once_and_as_a_file(
    api: Api, address: str, parts: Callable[..., Any]
) -> None:
    twice = [*parts({"reference_ED_lv_endo": STL}), ("reference_ED_lv_endo", ("b", STL))]
    as_text = [*parts({}), ("reference_ED_lv_endo", (None, "solid"))]
    for sent, said in ((twice, "more than once"), (as_text, "filename")):
        problem = problem_of(api.client.post(address, files=sent), 422, ProblemType.INVALID_REQUEST)
        assert problem.pointer == "reference_ED_lv_endo"
        assert said in problem.detail


@pytest.mark.parametrize(
    ("surface", "options", "said"),
    [
        ("ES_lv_endo", {}, "no frame ES"),
        ("ED_rv_epi", {}, "too few contours of rv_epi"),
        ("ED_lv_epi", {"surfaces": ["lv_endo"]}, "options.surfaces"),
    ],
)
def test_a_reference_of_what_the_job_does_not_make_is_refused(
    api: Api, surface: str, options: dict[str, Any], said: str
) -> None:
    request = {**good_request(), "options": options}
    answer = api.client.post(CONTOURS, files=contours({f"reference_{surface}": STL}, request))
    problem = problem_of(answer, 422, ProblemType.INVALID_REQUEST)
    assert problem.pointer == f"reference_{surface}"
    assert said in problem.detail
    assert list(api.store.root.iterdir()) == []


def test_the_study_of_a_form_is_judged_first(api: Api) -> None:
    request = good_request()
    request["study"]["units"] = "m"
    answer = api.client.post(CONTOURS, files=contours({"reference_ED_la": STL}, request))
    assert problem_of(answer, 422, ProblemType.INVALID_REQUEST).pointer == "reference_ED_la"
    answer = api.client.post(CONTOURS, files=contours({"reference_ES_epi": b""}, request))
    assert problem_of(answer, 422, ProblemType.IMPLAUSIBLE_SIZE).pointer == "/study/units"


def test_contours_in_a_form_take_no_label_map(api: Api) -> None:
    answer = api.client.post(CONTOURS, files=contours({"sax": b"x"}))
    assert problem_of(answer, 422, ProblemType.INVALID_REQUEST).pointer == "sax"


def test_what_only_the_maps_tell_is_left_to_the_worker(api: Api) -> None:
    answer = api.client.post(LABELS, files=labels({"reference_another_frame_epi": STL}))
    assert stored_references(api, answer) == {"another_frame_epi": STL}


@both
def test_too_many_triangles_are_refused(
    serve: Callable[[ServiceSettings], Api],
    settings: ServiceSettings,
    address: str,
    parts: Callable[..., Any],
) -> None:
    api = serve(settings.model_copy(update={"max_mesh_triangles": len(BALL.faces) - 1}))
    answer = api.client.post(address, files=parts({"reference_ED_lv_endo": STL}))
    problem = problem_of(answer, 413, ProblemType.TOO_LARGE)
    assert problem.pointer == "reference_ED_lv_endo"
    assert "at most 319" in problem.detail


def test_a_form_of_contours_is_counted_as_it_arrives(
    serve: Callable[[ServiceSettings], Api], settings: ServiceSettings
) -> None:
    api = serve(settings.model_copy(update={"max_request_bytes": 100_000}))
    answer = api.client.post(CONTOURS, files=contours({"reference_ED_lv_endo": STL * 20}))
    assert "100000 bytes" in problem_of(answer, 413, ProblemType.TOO_LARGE).detail
    assert list(api.store.root.iterdir()) == []


@pytest.mark.parametrize("content_type", ["multipart/form-data", "multipart/form-data; boundary=b"])
def test_a_broken_form_of_contours_is_a_problem(api: Api, content_type: str) -> None:
    answer = api.client.post(
        CONTOURS, content=b"no form at all", headers={"Content-Type": content_type}
    )
    problem_of(answer, 400, ProblemType.INVALID_REQUEST)
