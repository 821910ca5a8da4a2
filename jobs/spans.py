"""Spans of the traces that requests begin, sent to an OpenTelemetry collector where one is named.

On where the standard variable OTEL_EXPORTER_OTLP_ENDPOINT is set; otherwise nothing is loaded and
nothing is recorded. A span is recorded once it has ended, under the ids that `TraceContext` drew
and that travel from process to process. Attributes are ids, counts and words of our own, nothing
that a caller wrote.
"""

import os
from collections.abc import Mapping
from dataclasses import dataclass, field
from enum import StrEnum
from importlib.util import find_spec
from typing import Protocol

from jobs.trace_context import TraceContext

ENDPOINT = "OTEL_EXPORTER_OTLP_ENDPOINT"

_NEEDED = ("opentelemetry.sdk", "opentelemetry.exporter.otlp.proto.http")


class ExtraMissing(RuntimeError):  # noqa: N818 - it reads as what happened
    """Spans are wanted, and what sends them is not installed."""


class SpanKind(StrEnum):
    """Which side of a call it is, if it is one; the names are OpenTelemetry's."""

    INTERNAL = "internal"
    SERVER = "server"
    CLIENT = "client"


@dataclass(frozen=True)
class Span:
    """Something that took its time.

    place: its own ids. parent_id: the span id of what brought it about, None for the first.
    begun_s, ended_s: Unix times. failed: whether it is to be looked at.
    """

    name: str
    place: TraceContext
    parent_id: str | None
    begun_s: float
    ended_s: float
    kind: SpanKind = SpanKind.INTERNAL
    attributes: Mapping[str, str | int] = field(default_factory=dict)
    failed: bool = False


class Recorder(Protocol):
    """Takes spans and returns at once. What cannot be sent is dropped, and said in the log."""

    def record(self, span: Span) -> None: ...

    def stop(self) -> None: ...


_recorder: Recorder | None = None


def are_wanted() -> bool:
    """Whether the environment names a collector."""
    return bool(os.environ.get(ENDPOINT))


def require_extra() -> None:
    """Raise ExtraMissing where spans are wanted and cannot be sent."""
    if are_wanted() and not all(_is_installed(module) for module in _NEEDED):
        raise ExtraMissing(
            f"{ENDPOINT} is set, but the extra `otel` is not installed. Remedy: "
            "pip install 'neuralmri[otel]', build the image with --build-arg OTEL=true, or unset "
            "the variable."
        )


def start(service_name: str) -> None:
    """Record from now on, if spans are wanted. To be called after a fork, in the child.

    Raises ExtraMissing.
    """
    global _recorder
    require_extra()
    if are_wanted() and _recorder is None:
        from jobs.span_export import SpanExport

        _recorder = SpanExport(service_name)


def stop() -> None:
    """Send what waits, for two seconds at most, and record no more."""
    global _recorder
    if _recorder is not None:
        _recorder.stop()
        _recorder = None


def are_recorded() -> bool:
    """Whether this process records spans."""
    return _recorder is not None


def record(span: Span) -> None:
    """Hand a span over, if its trace is one that is recorded."""
    if _recorder is not None:
        _recorder.record(span)


def _is_installed(module: str) -> bool:
    try:
        return find_spec(module) is not None
    except ModuleNotFoundError:  # one of its parents is not there
        return False
