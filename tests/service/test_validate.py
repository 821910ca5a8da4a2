"""Judging without keeping: what submitting says, and nothing left behind."""

import json
from collections.abc import Callable
from typing import Any

import httpx
import pytest

from schemas.problem import ProblemType
from schemas.validation import Validation
from service.examples import CONTOUR_REQUEST
from service.settings import ServiceSettings
from tests.labelmaps.catalogue import CATALOGUE, LabelMapCase
from tests.redis_server import free_port
from tests.service.conftest import Api
from tests.service.test_jobs import problem_of
from tests.service.test_submit_labels import GOOD, form
from tests.studies.catalogue import BAD_STUDIES, BadStudy

JSON = {"Content-Type": "application/json"}


def both(api: Api, kind: str, **content: Any) -> tuple[httpx.Response, httpx.Response]:
    """What validating and submitting the same say."""
    return (
        api.client.post(f"/v1/validate/{kind}", **content),
        api.client.post(f"/v1/jobs/{kind}", **content),
    )


def but_for_the_call(answer: httpx.Response) -> dict[str, Any]:
    problem: dict[str, Any] = answer.json()
    assert problem.pop("instance")
    assert problem.pop("trace_id")
    return problem


def nothing_is_kept(api: Api) -> bool:
    return list(api.store.root.iterdir()) == [] and api.records.ids() == []


@pytest.mark.parametrize("bad", BAD_STUDIES, ids=lambda bad: bad.name)
def test_a_bad_study_is_refused_as_a_submission_would_be(api: Api, bad: BadStudy) -> None:
    judged, submitted = both(api, "contours", content=bad.raw, headers=JSON)
    assert judged.status_code == submitted.status_code == bad.status
    assert judged.headers["content-type"] == "application/problem+json"
    assert but_for_the_call(judged) == but_for_the_call(submitted)


@pytest.mark.parametrize(
    "case", [c for c in CATALOGUE if c.where == "door"], ids=lambda case: case.name
)
def test_bad_label_maps_are_refused_as_a_submission_would_be(api: Api, case: LabelMapCase) -> None:
    parts = form(dict(case.files()), dict(case.request))
    judged, submitted = both(api, "labels", files=parts)
    assert judged.status_code == submitted.status_code == case.status
    assert but_for_the_call(judged) == but_for_the_call(submitted)


def test_a_good_study_is_told_what_would_become_of_it(api: Api) -> None:
    options = {"ensemble": 2, "holdout": "leave_one_slice_out"}
    answer = api.client.post(
        "/v1/validate/contours", json={**CONTOUR_REQUEST, "options": options}, headers=JSON
    )
    assert answer.status_code == 200, answer.text
    assert answer.json() == {
        "valid": True,
        "surfaces": {"ED": ["lv_endo", "lv_epi"]},
        "warnings": [],
        "effort_fits": 1 + 2 + 6 / 2,
    }
    assert nothing_is_kept(api)


def test_only_requested_surfaces_are_listed_and_warnings_are_given(api: Api) -> None:
    study = json.loads(json.dumps(CONTOUR_REQUEST["study"]))
    study["frames"][0]["slices"] = study["frames"][0]["slices"][:2]
    options = {"surfaces": ["lv_endo"]}
    answer = api.client.post("/v1/validate/contours", json={"study": study, "options": options})
    validation = Validation.model_validate(answer.json())
    assert validation.surfaces == {"ED": ["lv_endo"]}
    assert any("2 planes only" in warning for warning in validation.warnings)


def test_references_beside_a_study_are_judged_too(api: Api) -> None:
    parts = form({"reference_ED_rv_endo": b"solid"}, CONTOUR_REQUEST)
    problem = problem_of(
        api.client.post("/v1/validate/contours", files=parts), 422, ProblemType.INVALID_REQUEST
    )
    assert problem.pointer == "reference_ED_rv_endo"


@pytest.mark.parametrize(
    ("options", "effort_fits"),
    [({}, 1.0), ({"ensemble": 3}, 4.0), ({"holdout": "leave_one_slice_out"}, None)],
)
def test_good_label_maps_are_good_as_far_as_headers_tell(
    api: Api, options: dict[str, Any], effort_fits: float | None
) -> None:
    parts = form(dict(GOOD.files()), {**GOOD.request, "options": options})
    answer = api.client.post("/v1/validate/labels", files=parts)
    assert answer.status_code == 200, answer.text
    assert answer.json() == {
        "valid": True,
        "surfaces": None,
        "warnings": [],
        "effort_fits": effort_fits,
    }
    assert nothing_is_kept(api)


def test_no_redis_is_needed(
    serve: Callable[[ServiceSettings], Api], settings: ServiceSettings
) -> None:
    nowhere = f"redis://127.0.0.1:{free_port()}/0"
    api = serve(settings.model_copy(update={"redis_url": nowhere}))
    assert api.client.post("/v1/validate/contours", json=CONTOUR_REQUEST).status_code == 200
    parts = form(dict(GOOD.files()), dict(GOOD.request))
    assert api.client.post("/v1/validate/labels", files=parts).status_code == 200
