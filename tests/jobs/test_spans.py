"""Spans, recorded for real and sent to a collector that is there, slow, refusing, or away."""

import subprocess
import sys
import threading
from collections.abc import Iterator
from dataclasses import replace

import pytest
from opentelemetry.proto.trace.v1.trace_pb2 import Span as WireSpan

from jobs import spans
from jobs.spans import ENDPOINT, ExtraMissing, Span, SpanKind
from jobs.trace_context import TraceContext
from tests.collector import Collector, collecting
from tests.redis_server import free_port

ROOT = replace(TraceContext.begun(), is_sampled=True)


@pytest.fixture
def collector() -> Iterator[Collector]:
    with collecting() as found:
        yield found


@pytest.fixture(autouse=True)
def _quick_and_stopped(monkeypatch: pytest.MonkeyPatch) -> Iterator[None]:
    monkeypatch.setenv("OTEL_BSP_SCHEDULE_DELAY", "50")
    yield
    spans.stop()


def started(url: str, monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setenv(ENDPOINT, url)
    spans.start("neuralmri-test")


def test_nothing_is_recorded_where_no_collector_is_named(
    monkeypatch: pytest.MonkeyPatch,
) -> None:
    monkeypatch.delenv(ENDPOINT, raising=False)
    spans.start("neuralmri-test")
    assert not spans.are_recorded()
    spans.record(Span("nobody hears it", ROOT, None, 1.0, 2.0))


def test_a_span_arrives_as_it_was_recorded(
    collector: Collector, monkeypatch: pytest.MonkeyPatch
) -> None:
    started(collector.url, monkeypatch)
    child = ROOT.child()
    about = {"neuralmri.job.id": "019c", "neuralmri.job.attempt": 2}
    spans.record(Span("first", ROOT, None, 1000.0, 1002.5, SpanKind.SERVER))
    spans.record(Span("second", child, ROOT.span_id, 1001.0, 1000.0, attributes=about, failed=True))
    spans.stop()
    first, second = sorted(collector.spans, key=lambda span: span.name)
    assert first.service == second.service == "neuralmri-test"
    assert (first.trace_id, first.span_id, first.parent_id) == (ROOT.trace_id, ROOT.span_id, "")
    assert second.trace_id == ROOT.trace_id
    assert (second.span_id, second.parent_id) == (child.span_id, ROOT.span_id)
    assert (first.begun_ns, first.ended_ns) == (1000_000_000_000, 1002_500_000_000)
    assert second.begun_ns == second.ended_ns, "never shorter than nothing"
    assert first.kind == WireSpan.SPAN_KIND_SERVER
    assert second.kind == WireSpan.SPAN_KIND_INTERNAL
    assert (first.failed, second.failed) == (False, True)
    assert second.attributes == about


def test_a_trace_that_its_beginner_does_not_record_is_not_recorded_here(
    collector: Collector, monkeypatch: pytest.MonkeyPatch
) -> None:
    started(collector.url, monkeypatch)
    spans.record(Span("unheard", replace(ROOT, is_sampled=False), "00f067aa0ba902b7", 1.0, 2.0))
    spans.record(Span("heard", ROOT.child(), ROOT.span_id, 1.0, 2.0))
    spans.stop()
    assert [span.name for span in collector.spans] == ["heard"]


def test_a_name_of_the_service_may_be_given(
    collector: Collector, monkeypatch: pytest.MonkeyPatch
) -> None:
    monkeypatch.setenv("OTEL_SERVICE_NAME", "hearts")
    started(collector.url, monkeypatch)
    spans.record(Span("named", ROOT, None, 1.0, 2.0))
    spans.stop()
    assert [span.service for span in collector.spans] == ["hearts"]


def test_a_collector_that_is_away_holds_nobody_up(monkeypatch: pytest.MonkeyPatch) -> None:
    started(f"http://127.0.0.1:{free_port()}", monkeypatch)
    for _ in range(5000):  # more than the queue holds
        spans.record(Span("lost", ROOT, None, 1.0, 2.0))
    spans.stop()
    spans.record(Span("after the end", ROOT, None, 1.0, 2.0))


def test_a_collector_that_never_answers_holds_nobody_up(
    collector: Collector, monkeypatch: pytest.MonkeyPatch
) -> None:
    answering = threading.Event()
    collector.before_reply = lambda: answering.wait(60.0)
    started(collector.url, monkeypatch)
    spans.record(Span("lost", ROOT, None, 1.0, 2.0))
    spans.stop()
    assert not answering.is_set(), "it was not waited for"
    assert collector.spans == []
    answering.set()


def test_a_collector_that_refuses_is_only_said_in_the_log(
    collector: Collector, monkeypatch: pytest.MonkeyPatch, caplog: pytest.LogCaptureFixture
) -> None:
    collector.status = 400
    started(collector.url, monkeypatch)
    spans.record(Span("refused", ROOT, None, 1.0, 2.0))
    spans.stop()
    assert "400" in caplog.text


def test_an_extra_that_is_missing_is_named(monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setattr(spans, "find_spec", lambda _module: None)
    monkeypatch.delenv(ENDPOINT, raising=False)
    spans.require_extra()
    monkeypatch.setenv(ENDPOINT, "http://127.0.0.1:4318")
    with pytest.raises(ExtraMissing, match=r"neuralmri\[otel\]"):
        spans.start("neuralmri-test")


@pytest.mark.parametrize(
    "start", ["import worker.app", "from service.process import app_of_process as f; f()"]
)
def test_a_process_without_the_extra_does_not_start(
    start: str, monkeypatch: pytest.MonkeyPatch
) -> None:
    monkeypatch.setenv(ENDPOINT, "http://127.0.0.1:4318")
    absent = "import sys; sys.modules['opentelemetry.sdk'] = None"
    ended = subprocess.run(
        [sys.executable, "-c", f"{absent}; {start}"], capture_output=True, text=True, check=False
    )
    assert ended.returncode != 0
    assert "Remedy: pip install 'neuralmri[otel]'" in ended.stderr.splitlines()[-1]
