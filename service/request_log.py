"""One log line a request, and the trace that the request is part of."""

import logging
import time

from starlette.datastructures import Headers
from starlette.types import ASGIApp, Message, Receive, Scope, Send

from jobs import log_context
from jobs.log_context import LogContext
from jobs.store import is_job_id
from jobs.trace_context import TraceContext
from service.route_template import method_and_route

log = logging.getLogger("neuralmri.access")

_PROBES = {"/healthz", "/readyz", "/metrics"}


class RequestLog:
    """ASGI middleware: enters the request's log context, and logs the request when it is answered.

    The trace is the one of the header `traceparent`; a new one where there is none, or two, or one
    that cannot be read. The line has method, route template, status and duration, and the job's id
    if it is one: no path, no query, no address. Probes that succeed are DEBUG.
    """

    def __init__(self, app: ASGIApp) -> None:
        self.app = app

    async def __call__(self, scope: Scope, receive: Receive, send: Send) -> None:
        if scope["type"] != "http":
            await self.app(scope, receive, send)
            return
        context = log_context.enter(LogContext(trace=_trace(scope)))
        status = 500
        start = time.perf_counter()

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
            log.log(
                logging.DEBUG if quiet else logging.INFO,
                "%s %s %s",
                method,
                route,
                status,
                extra={"fields": fields},
            )


def _trace(scope: Scope) -> TraceContext:
    sent = Headers(scope=scope).getlist("traceparent")
    trace = TraceContext.parsed(sent[0]) if len(sent) == 1 else None
    return trace.child() if trace else TraceContext.begun()
