"""Every answer is told how to be treated: results, problems, and crashes."""

import asyncio

import httpx
import pytest

from schemas.job import JobState
from service.app import create_app
from service.settings import ServiceSettings
from tests.service.conftest import Api
from tests.service.jobs_done import finish
from tests.service.test_jobs import submitted


def check(headers: httpx.Headers) -> None:
    assert headers["x-content-type-options"] == "nosniff"
    assert headers["referrer-policy"] == "no-referrer"
    assert headers["cross-origin-resource-policy"] == "same-origin"
    assert "default-src 'none'" in headers["content-security-policy"]


@pytest.mark.parametrize(
    ("method", "path"),
    [
        ("GET", "/healthz"),
        ("GET", "/readyz"),
        ("GET", "/metrics"),
        ("GET", "/openapi.json"),
        ("GET", "/v1/jobs"),
        ("GET", "/v1/jobs?limit=x"),
        ("GET", "/nowhere"),
        ("PUT", "/v1/jobs"),
        ("POST", "/v1/jobs/contours"),
        ("POST", "/v1/validate/contours"),
        ("DELETE", "/v1/jobs/nonsense"),
    ],
)
def test_every_answer_is_private_and_inert(api: Api, method: str, path: str) -> None:
    headers = api.client.request(method, path).headers
    check(headers)
    assert headers["cache-control"] == "no-store"


def test_results_are_private_and_checked_anew(api: Api) -> None:
    job_id = submitted(api)
    finish(api.store, api.records, job_id, JobState.SUCCEEDED)
    here = f"/v1/jobs/{job_id}"
    for path in (here, f"{here}/artifacts"):
        headers = api.client.get(path).headers
        check(headers)
        assert headers["cache-control"] == "no-store"
    for path in (f"{here}/report", f"{here}/artifacts/ED_lv_endo.stl"):
        headers = api.client.get(path).headers
        check(headers)
        assert headers["cache-control"] == "private, no-cache"


def test_a_crash_says_nothing_and_carries_the_headers(settings: ServiceSettings) -> None:
    app = create_app(settings)

    @app.get("/crash")
    def crash() -> None:
        raise RuntimeError("a path of ours")

    async def ask() -> httpx.Response:
        transport = httpx.ASGITransport(app, raise_app_exceptions=False)
        async with httpx.AsyncClient(transport=transport, base_url="http://here") as client:
            return await client.get("/crash")

    answer = asyncio.run(ask())
    assert answer.status_code == 500
    assert "a path of ours" not in answer.text
    check(answer.headers)
    assert answer.headers["cache-control"] == "no-store"
