"""A result is had again from a server with a real worker, which says by which code it works."""

import httpx
import pytest

from tests.end_to_end.following import follow
from tests.end_to_end.serve_process import ServeProcess

pytestmark = [pytest.mark.integration, pytest.mark.slow]

QUICK = {"preset": "fast", "levels": 1, "iterations_per_level": 20, "mesh": {"grid_mm": 4.0}}


def test_the_same_study_is_answered_with_its_earlier_job(
    server: ServeProcess, study: dict[str, object]
) -> None:
    def sent() -> httpx.Response:
        body = {"study": study, "options": QUICK}
        url = f"{server.url}/v1/jobs/contours"
        return httpx.post(url, params={"reuse": "true"}, json=body, timeout=30)

    first = sent()
    assert first.status_code == 202, first.text
    job_id = first.json()["id"]
    follow(server, job_id, "succeeded")
    again = sent()
    assert (again.status_code, again.json()["id"]) == (200, job_id)
    assert httpx.delete(f"{server.url}/v1/jobs/{job_id}", timeout=30).status_code == 204
    assert sent().status_code == 202
