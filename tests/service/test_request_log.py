"""The log line of a request, and the trace that it is part of."""

import json
import logging
import re
import time
from typing import Any

import pytest
from httpx import Response

from schemas.problem import ProblemType
from service.examples import CONTOUR_REQUEST
from tests.service.conftest import Api
from tests.service.test_jobs import problem_of, submitted

TRACE = "4bf92f3577b34da6a3ce929d0e0e4736"
SENT = f"00-{TRACE}-00f067aa0ba902b7-01"


def post(api: Api, *traceparents: str) -> Response:
    headers = [("traceparent", value) for value in traceparents]
    answer = api.client.post("/v1/jobs/contours", json=CONTOUR_REQUEST, headers=headers)
    assert answer.status_code == 202, answer.text
    return answer


def lines(caplog: pytest.LogCaptureFixture, count: int) -> list[logging.LogRecord]:
    """The newest lines, once there are so many: one is written after its answer."""
    deadline = time.monotonic() + 5.0
    while True:
        found = [record for record in caplog.records if record.name == "neuralmri.access"]
        if len(found) >= count:
            return found[-count:]
        assert time.monotonic() < deadline
        time.sleep(0.01)


def fields(record: logging.LogRecord) -> dict[str, Any]:
    found: dict[str, Any] = vars(record)["fields"]
    return found


def test_a_job_is_part_of_the_trace_of_its_request(api: Api) -> None:
    job = post(api, SENT).json()
    assert job["trace_id"] == TRACE
    stored = api.store.folder(job["id"]).request().traceparent
    assert stored is not None
    assert re.fullmatch(rf"00-{TRACE}-[0-9a-f]{{16}}-01", stored)
    assert stored != SENT, "a place of its own"
    assert api.client.get(f"/v1/jobs/{job['id']}").json()["trace_id"] == TRACE


def test_the_message_carries_the_trace_in_its_headers(api: Api) -> None:
    job_id = post(api, SENT).json()["id"]
    (message,) = api.redis.lrange("neuralmri", 0, -1)
    headers = json.loads(message)["headers"]
    assert headers["traceparent"] == api.store.folder(job_id).request().traceparent


@pytest.mark.parametrize("sent", [(), ("00-jane-doe-01",), (SENT, SENT)])
def test_without_a_header_that_can_be_read_a_trace_begins(api: Api, sent: tuple[str, ...]) -> None:
    first, second = (post(api, *sent).json()["trace_id"] for _ in range(2))
    assert re.fullmatch("[0-9a-f]{32}", first)
    assert len({first, second, TRACE}) == 3


def test_a_trace_outlives_redis(api: Api) -> None:
    job_id = post(api, SENT).json()["id"]
    api.redis.flushall()
    assert api.client.get(f"/v1/jobs/{job_id}").json()["trace_id"] == TRACE


def test_a_problem_says_under_which_trace_the_log_has_it(api: Api) -> None:
    answer = api.client.get("/v1/jobs/nobody", headers={"traceparent": SENT})
    assert problem_of(answer, 404, ProblemType.NOT_FOUND).trace_id == TRACE


def test_a_line_has_route_status_and_job_and_nothing_that_a_caller_wrote(
    api: Api, caplog: pytest.LogCaptureFixture
) -> None:
    caplog.set_level(logging.DEBUG, "neuralmri.access")
    job_id = submitted(api)
    api.client.get(f"/v1/jobs/{job_id}?name=jane-doe")
    api.client.get("/v1/jobs/jane-doe")
    api.client.get("/jane-doe")
    api.client.request("JANE", "/v1/jobs")
    said = [fields(record) for record in lines(caplog, 5)]
    assert [(line["method"], line["route"], line["status"]) for line in said] == [
        ("POST", "/v1/jobs/contours", 202),
        ("GET", "/v1/jobs/{job_id}", 200),
        ("GET", "/v1/jobs/{job_id}", 404),
        ("GET", "unmatched", 404),
        ("other", "/v1/jobs", 405),
    ]
    assert all(line["duration_s"] >= 0 for line in said)
    assert "jane" not in caplog.text.lower()


def test_probes_that_succeed_are_no_news(api: Api, caplog: pytest.LogCaptureFixture) -> None:
    caplog.set_level(logging.DEBUG, "neuralmri.access")
    api.client.get("/healthz")
    api.client.get("/readyz")
    levels = [record.levelno for record in lines(caplog, 2)]
    assert levels == [logging.DEBUG, logging.INFO]
