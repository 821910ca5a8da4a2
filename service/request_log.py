"""One log line a request, and the trace that the request is part of."""

import logging
import time
from dataclasses import replace

from starlette.datastructures import Headers
from starlette.types import ASGIApp, Message, Receive, Scope, Send

from jobs import log_context, spans
from jobs.log_context import LogContext
from jobs.spans import Span, SpanKind
from jobs.store import is_job_id
from jobs.trace_context import TraceContext
from service.route_template import method_and_route

log = logging.getLogger("neuralmri.access")

_PROBES = {"/healthz", "/readyz", "/metrics"}


class RequestLog:
    """ASGI middleware: enters the request's log context, and logs the request when it is answered.

    The trace is the one of the header `traceparent`; a new one where there is none, or two, or one
    that cannot be read. The line has method, route template, status and duration, and the job's id
    if it is one: no path, no query, no address. Probes that succeed are DEBUG, and no spans.
    """

    def __init__(self, app: ASGIApp) -> None:
        self.app = app

    async def __call__(self, scope: Scope, receive: Receive, send: Send) -> None:
        if scope["type"] != "http":
            await self.app(scope, receive, send)
            return
        caller = _caller(scope)
        trace = caller.child() if caller else _begun()
        context = log_context.enter(LogContext(trace=trace))
        status = 500
        start, begun_s = time.perf_counter(), time.time()

        async def send_noting_status(message: Message) -> None:
            nonlocal status
            if message["type"] == "http.response.start":
                status = message["status"]
            await send(message)

        try:
            await self.app(scope, receive, send_noting_status)
        finally:
            method, route = method_and_route(scope)
            asked = scope.get("path_params", {}).get("job_id", "")
            if is_job_id(asked) and context.job_id is None:
                context.job_id = asked
            fields = {
                "method": method,
                "route": route,
                "status": status,
                "duration_s": round(time.perf_counter() - start, 4),
            }
            quiet = route in _PROBES and status < 400
            if not quiet:
                spans.record(_span(method, route, status, begun_s, context, caller, trace))
            log.log(
                logging.DEBUG if quiet else logging.INFO,
                "%s %s %s",
                method,
                route,
                status,
                extra={"fields": fields},
            )


def _caller(scope: Scope) -> TraceContext | None:
    """Where the request comes from, as it says itself."""
    sent = Headers(scope=scope).getlist("traceparent")
    return TraceContext.parsed(sent[0]) if len(sent) == 1 else None


def _begun() -> TraceContext:
    """A new trace, recorded where this process records any."""
    return replace(TraceContext.begun(), is_sampled=spans.are_recorded())


def _span(
    method: str,
    route: str,
    status: int,
    begun_s: float,
    context: LogContext,
    caller: TraceContext | None,
    place: TraceContext,
) -> Span:
    attributes: dict[str, str | int] = {
        "http.request.method": method,
        "http.route": route,
        "http.response.status_code": status,
    }
    if context.job_id is not None:
        attributes["neuralmri.job.id"] = context.job_id
    return Span(
        f"{method} {route}",
        place,
        caller.span_id if caller else None,
        begun_s,
        time.time(),
        SpanKind.SERVER,
        attributes,
        failed=status >= 500,
    )
