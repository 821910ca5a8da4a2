"""What pages of other origins may have a browser do here: nothing, unless a setting names them."""

from collections.abc import Callable

import pytest
from pydantic import ValidationError

from schemas.problem import ProblemType
from service.examples import CONTOUR_REQUEST
from service.origins import parse_origins
from service.settings import ServiceSettings
from tests.service.conftest import Api
from tests.service.test_jobs import problem_of, submitted

VIEWER = "https://viewer.example.org"
EVIL = "https://evil.example.com"


@pytest.fixture
def open_api(serve: Callable[[ServiceSettings], Api], settings: ServiceSettings) -> Api:
    return serve(settings.model_copy(update={"cors_origins": VIEWER}))


def preflight(origin: str, method: str = "POST", headers: str = "content-type") -> dict[str, str]:
    return {
        "Origin": origin,
        "Access-Control-Request-Method": method,
        "Access-Control-Request-Headers": headers,
    }


def test_it_is_off_by_default(api: Api) -> None:
    answer = api.client.get("/v1/jobs", headers={"Origin": VIEWER})
    assert answer.status_code == 200
    assert not [name for name in answer.headers if name.startswith("access-control-")]
    asked = api.client.options("/v1/jobs/contours", headers=preflight(VIEWER))
    problem_of(asked, 405, ProblemType.METHOD_NOT_ALLOWED)
    assert "access-control-allow-origin" not in asked.headers


@pytest.mark.parametrize("method", ["GET", "POST", "DELETE"])
def test_a_listed_origin_may_ask_and_read(open_api: Api, method: str) -> None:
    headers = preflight(VIEWER, method, "content-type, idempotency-key, prefer, range, traceparent")
    asked = open_api.client.options("/v1/jobs/contours", headers=headers)
    assert asked.status_code == 200
    assert asked.headers["access-control-allow-origin"] == VIEWER
    assert method in asked.headers["access-control-allow-methods"]
    answer = open_api.client.post(
        "/v1/jobs/contours",
        json=CONTOUR_REQUEST,
        headers={"Origin": VIEWER, "Sec-Fetch-Site": "cross-site"},
    )
    assert answer.status_code == 202
    assert answer.headers["access-control-allow-origin"] == VIEWER
    assert "Location" in answer.headers["access-control-expose-headers"]
    assert "access-control-allow-credentials" not in answer.headers


def test_a_listed_origin_reads_problems_too(open_api: Api) -> None:
    for path, method, status in (("/nowhere", "GET", 404), ("/v1/jobs", "PUT", 405)):
        answer = open_api.client.request(method, path, headers={"Origin": VIEWER})
        assert answer.status_code == status
        assert answer.headers["access-control-allow-origin"] == VIEWER


@pytest.mark.parametrize(
    "origin", [EVIL, "null", f"{VIEWER}.evil.com", "http://viewer.example.org"]
)
def test_another_origin_is_told_nothing(open_api: Api, origin: str) -> None:
    answer = open_api.client.get("/v1/jobs", headers={"Origin": origin})
    assert "access-control-allow-origin" not in answer.headers
    assert "Origin" in answer.headers["vary"]
    asked = open_api.client.options("/v1/jobs/contours", headers=preflight(origin))
    problem_of(asked, 400, ProblemType.INVALID_REQUEST)
    assert "access-control-allow-origin" not in asked.headers


@pytest.mark.parametrize(
    "headers",
    [
        {"Origin": EVIL, "Sec-Fetch-Site": "cross-site"},
        {"Origin": EVIL, "Sec-Fetch-Site": "same-site"},
        {"Sec-Fetch-Site": "cross-site"},
        {"Origin": EVIL},
        {"Origin": "null"},
    ],
)
@pytest.mark.parametrize("call", ["submit", "cancel", "restart", "erase"])
def test_a_page_of_another_origin_changes_nothing(
    api: Api, headers: dict[str, str], call: str
) -> None:
    job_id = submitted(api)
    form = {"request": (None, "{}")}
    if call == "submit":
        answer = api.client.post("/v1/jobs/labels", files=form, headers=headers)
    elif call == "erase":
        answer = api.client.delete(f"/v1/jobs/{job_id}", headers=headers)
    else:
        answer = api.client.post(f"/v1/jobs/{job_id}/{call}", headers=headers)
    problem_of(answer, 403, ProblemType.CROSS_ORIGIN)
    assert api.client.get(f"/v1/jobs/{job_id}").json()["state"] == "queued"


@pytest.mark.parametrize("named", [{}, {"Sec-Fetch-Site": "same-origin"}])
def test_the_service_s_own_pages_may(api: Api, named: dict[str, str]) -> None:
    own = {"Origin": str(api.client.base_url).rstrip("/"), **named}
    answer = api.client.post("/v1/jobs/contours", json=CONTOUR_REQUEST, headers=own)
    assert answer.status_code == 202


@pytest.mark.parametrize(
    "text",
    ["*", "null", "https://a.org/", "https://a.org/x", "a.org", "https://*.a.org", "HTTP://A"],
)
def test_only_exact_origins_are_settings(text: str) -> None:
    with pytest.raises(ValidationError, match="exact origin"):
        ServiceSettings(cors_origins=text)


def test_several_origins_are_separated_by_spaces() -> None:
    assert parse_origins("https://a.org  http://localhost:3000 http://[::1]:80") == (
        "https://a.org",
        "http://localhost:3000",
        "http://[::1]:80",
    )
    assert parse_origins("off") == ServiceSettings().origins == ()
