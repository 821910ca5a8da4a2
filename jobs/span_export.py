"""Spans on their way to a collector, over OTLP/HTTP. The one file that knows OpenTelemetry.

It is loaded only where spans are wanted: `opentelemetry-sdk` comes with the extra `otel`. How to
send (headers, certificates, timeouts, batches) is said by the standard's own variables, OTEL_...
"""

import os
import threading
from contextvars import ContextVar
from importlib.metadata import version

from opentelemetry.context import Context
from opentelemetry.exporter.otlp.proto.http.trace_exporter import OTLPSpanExporter
from opentelemetry.sdk.resources import Resource
from opentelemetry.sdk.trace import TracerProvider
from opentelemetry.sdk.trace.export import BatchSpanProcessor
from opentelemetry.sdk.trace.id_generator import IdGenerator
from opentelemetry.sdk.trace.sampling import ALWAYS_ON, ParentBased
from opentelemetry.trace import (
    NonRecordingSpan,
    SpanContext,
    SpanKind,
    Status,
    StatusCode,
    TraceFlags,
    set_span_in_context,
)

from jobs.spans import Span
from jobs.trace_context import TraceContext

_STOPS_WITHIN_S = 2.0

_place: ContextVar[TraceContext] = ContextVar("place_of_span")


class _DrawnIds(IdGenerator):
    """The ids of the span that is being recorded, instead of new ones."""

    def generate_span_id(self) -> int:
        return int(_place.get().span_id, 16)

    def generate_trace_id(self) -> int:
        return int(_place.get().trace_id, 16)


class SpanExport:
    """Records spans of the traces that whoever began them records; a thread sends them in batches.

    The queue is bounded: where the collector does not keep up or is away, spans are dropped.
    """

    def __init__(self, service_name: str) -> None:
        resource = Resource.create(
            {
                "service.name": os.environ.get("OTEL_SERVICE_NAME") or service_name,
                "service.version": version("neuralmri"),
            }
        )
        self._processor = BatchSpanProcessor(OTLPSpanExporter())
        provider = TracerProvider(
            resource=resource,
            sampler=ParentBased(ALWAYS_ON),
            id_generator=_DrawnIds(),
            shutdown_on_exit=False,  # it would wait for a collector that is away
        )
        provider.add_span_processor(self._processor)
        self._tracer = provider.get_tracer("neuralmri", version("neuralmri"))

    def record(self, span: Span) -> None:
        if not span.place.is_sampled:
            return
        token = _place.set(span.place)
        try:
            recorded = self._tracer.start_span(
                span.name,
                # An empty context, so that nothing around us is taken for the parent.
                context=set_span_in_context(NonRecordingSpan(_parent(span)), Context()),
                kind=SpanKind[span.kind.name],
                attributes=dict(span.attributes),
                start_time=_ns(span.begun_s),
            )
        finally:
            _place.reset(token)
        if span.failed:
            recorded.set_status(Status(StatusCode.ERROR))
        recorded.end(_ns(max(span.begun_s, span.ended_s)))

    def stop(self) -> None:
        """Send what waits. A collector that does not answer is not waited for."""
        last = threading.Thread(target=self._processor.shutdown, name="last-spans", daemon=True)
        last.start()
        last.join(_STOPS_WITHIN_S)


def _parent(span: Span) -> SpanContext:
    """The parent's place; one that is not valid, which means none, for the first of a trace."""
    return SpanContext(
        trace_id=int(span.place.trace_id, 16),
        span_id=int(span.parent_id or "0", 16),
        is_remote=True,
        trace_flags=TraceFlags(TraceFlags.SAMPLED),
    )


def _ns(instant_s: float) -> int:
    return int(instant_s * 1e9)
