"""GET /metrics, and what is counted for it of requests as they pass."""

import time

from fastapi import APIRouter, Response
from prometheus_client import CollectorRegistry, Counter, Histogram, generate_latest
from prometheus_client.exposition import CONTENT_TYPE_LATEST
from starlette.types import ASGIApp, Message, Receive, Scope, Send

from service.access import JobAccess
from service.documented import problems
from service.host_metrics import HostMetrics
from service.job_metrics import JobMetrics
from service.readiness_metrics import ReadinessMetrics
from service.route_template import method_and_route
from service.tokens.keys_at_hand import KeysAtHand
from service.webhooks.desk import WebhookDesk
from service.webhooks.metrics import WebhookMetrics


class RequestMetrics:
    """Counts and durations of requests by method, route and status, in a registry of their own."""

    def __init__(self) -> None:
        self.registry = CollectorRegistry()
        self._requests = Counter(
            "neuralmri_http_requests",
            "Requests answered.",
            ["method", "route", "status"],
            registry=self.registry,
        )
        self._seconds = Histogram(
            "neuralmri_http_request_duration_seconds",
            "From the request's headers to the end of the answer.",
            ["method", "route"],
            registry=self.registry,
        )

    def middleware(self, app: ASGIApp) -> ASGIApp:
        """`app`, watched."""

        async def watched(scope: Scope, receive: Receive, send: Send) -> None:
            if scope["type"] != "http":
                await app(scope, receive, send)
                return
            status = 500
            start = time.perf_counter()

            async def send_noting_status(message: Message) -> None:
                nonlocal status
                if message["type"] == "http.response.start":
                    status = message["status"]
                await send(message)

            try:
                await app(scope, receive, send_noting_status)
            finally:
                method, route = method_and_route(scope)
                self._requests.labels(method, route, str(status)).inc()
                self._seconds.labels(method, route).observe(time.perf_counter() - start)

        return watched


def metrics_route(
    registry: CollectorRegistry, access: JobAccess, desk: WebhookDesk, issuer_keys: KeysAtHand
) -> APIRouter:
    """GET /metrics."""
    router = APIRouter(tags=["operation"])
    registry.register(JobMetrics(access))
    registry.register(HostMetrics(access.store))
    registry.register(ReadinessMetrics(access, issuer_keys))
    registry.register(WebhookMetrics(desk.endpoints, desk.outbox, desk.attempts))

    @router.get(
        "/metrics",
        response_class=Response,
        responses={200: {"content": {"text/plain": {}}}, **problems()},
    )
    def metrics() -> Response:
        """Prometheus text format."""
        return Response(generate_latest(registry), media_type=CONTENT_TYPE_LATEST)

    return router
