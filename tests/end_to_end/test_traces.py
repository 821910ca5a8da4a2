"""One trace from request to webhook, through real processes, as a collector gets it."""

from collections.abc import Iterator
from itertools import pairwise
from pathlib import Path
from typing import Any

import httpx
import pytest

from tests.collector import Collected, Collector, collecting
from tests.end_to_end.following import follow
from tests.end_to_end.serve_process import ServeProcess
from tests.service.webhooks.receiver import Receiver, receiving

pytestmark = [pytest.mark.integration, pytest.mark.slow]

SUBJECT = "Roe-Jane-1961"
TRACE = "4bf92f3577b34da6a3ce929d0e0e4736"
CALLER = "00f067aa0ba902b7"
QUICK = {"preset": "fast", "levels": 1, "iterations_per_level": 5, "mesh": {"grid_mm": 3}}
STAGES = ("reading", "fitting", "meshing", "measuring", "writing")


@pytest.fixture
def collector() -> Iterator[Collector]:
    with collecting() as found:
        yield found


@pytest.fixture
def receiver() -> Iterator[Receiver]:
    with receiving() as found:
        yield found


@pytest.fixture
def server(
    collector: Collector, tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> Iterator[ServeProcess]:
    monkeypatch.setenv("OTEL_EXPORTER_OTLP_ENDPOINT", collector.url)
    monkeypatch.setenv("OTEL_BSP_SCHEDULE_DELAY", "100")
    monkeypatch.setenv("NEURALMRI_WEBHOOK_ALLOW", "127.0.0.0/8")
    monkeypatch.setenv("NEURALMRI_WEBHOOK_HTTP", "true")
    monkeypatch.setenv("NEURALMRI_WEBHOOK_HIGH_PORTS", "true")
    process = ServeProcess(tmp_path / "data").wait_until_ready()
    yield process
    if process.process.poll() is None:
        process.stop()


def submitted(server: ServeProcess, study: dict[str, Any], flags: str) -> str:
    request = {"study": {**study, "subject_id": SUBJECT}, "options": QUICK}
    traced = {"traceparent": f"00-{TRACE}-{CALLER}-{flags}"}
    answer = httpx.post(f"{server.url}/v1/jobs/contours", json=request, headers=traced, timeout=30)
    assert answer.status_code == 202, answer.text
    job_id: str = answer.json()["id"]
    return job_id


def test_a_job_is_one_trace_from_request_to_webhook(
    server: ServeProcess, collector: Collector, receiver: Receiver, study: dict[str, Any]
) -> None:
    assert httpx.post(f"{server.url}/v1/webhooks", json={"url": receiver.url}).is_success
    unheard = submitted(server, study, "00")
    job_id = submitted(server, study, "01")
    for accepted in (unheard, job_id):
        follow(server, accepted, "succeeded")
    receiver.wait_for(2, within_s=60.0)
    collector.wait_for("POST /v1/jobs/contours", "job attempt", "webhook delivery")
    code, said = server.stop()
    assert code == 0, said

    spans = [span for span in collector.spans if span.trace_id == TRACE]
    assert all(span.attributes["neuralmri.job.id"] == job_id for span in spans)
    by_name = {span.name: span for span in spans}
    assert len(by_name) == len(spans), "each once"
    names = {f"job {stage}" for stage in STAGES}
    assert set(by_name) == {
        *names,
        *("POST /v1/jobs/contours", "job wait", "job attempt", "webhook delivery"),
    }
    request, attempt = by_name["POST /v1/jobs/contours"], by_name["job attempt"]
    assert request.parent_id == CALLER
    assert {by_name[name].parent_id for name in names} == {attempt.span_id}
    for name in ("job wait", "job attempt", "webhook delivery"):
        assert by_name[name].parent_id == request.span_id, name
    assert len({span.span_id for span in spans} | {CALLER}) == len(spans) + 1

    services = {span.name: span.service for span in spans}
    assert services["POST /v1/jobs/contours"] == "neuralmri-service"
    assert services["webhook delivery"] == "neuralmri-service"
    assert {services[name] for name in ("job attempt", *names)} == {"neuralmri-worker"}
    assert request.attributes["http.response.status_code"] == 202
    assert attempt.attributes["neuralmri.job.outcome"] == "succeeded"
    assert attempt.attributes["neuralmri.job.attempt"] == 1
    assert not any(span.failed for span in spans)
    _are_in_order(by_name, attempt)

    assert {span.name for span in collector.spans}.isdisjoint({"GET /readyz", "GET /healthz"})
    for telling in (SUBJECT, str(study["frames"][0]["slices"][0]["contours"][0]["points"][0][0])):
        assert all(telling.encode() not in body for body in collector.bodies)


def _are_in_order(by_name: dict[str, Collected], attempt: Collected) -> None:
    """By one clock: both processes are of this machine."""
    stages = [by_name[f"job {stage}"] for stage in STAGES]
    assert by_name["job wait"].ended_ns <= attempt.begun_ns <= stages[0].begun_ns
    for before, after in pairwise(stages):
        assert before.ended_ns <= after.begun_ns
    assert stages[-1].ended_ns <= attempt.ended_ns
    assert stages[-1].ended_ns <= by_name["webhook delivery"].begun_ns


def test_a_collector_that_is_away_costs_no_job_anything(
    server: ServeProcess, collector: Collector, study: dict[str, Any]
) -> None:
    collector.status = 503
    follow(server, submitted(server, study, "01"), "succeeded")
    code, said = server.stop()
    assert code == 0, said
    assert collector.spans == []
