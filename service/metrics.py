"""Prometheus metrics: requests, as they pass, and jobs, read from Redis when asked."""

import time
from collections.abc import Iterator

from fastapi import APIRouter, Response
from prometheus_client import CollectorRegistry, Counter, Histogram, generate_latest
from prometheus_client.core import GaugeMetricFamily, Metric
from prometheus_client.exposition import CONTENT_TYPE_LATEST
from prometheus_client.registry import Collector
from redis.exceptions import RedisError
from starlette.types import ASGIApp, Message, Receive, Scope, Send

from service.access import JobAccess
from service.documented import problems
from service.route_template import method_and_route


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


class JobMetrics(Collector):
    """Jobs by state, messages waiting and live workers, as Redis has them now."""

    def __init__(self, access: JobAccess) -> None:
        self._access = access

    def collect(self) -> Iterator[Metric]:
        up = GaugeMetricFamily("neuralmri_redis_up", "Whether Redis answers.")
        try:
            counts = self._access.records.counts()
            depth = self._access.queue.depth()
            workers = self._access.live_workers()
        except RedisError:
            up.add_metric([], 0.0)
            yield up
            return
        up.add_metric([], 1.0)
        yield up
        jobs = GaugeMetricFamily("neuralmri_jobs", "Jobs by state.", labels=["state"])
        for state, count in counts.items():
            jobs.add_metric([state.value], count)
        yield jobs
        waiting = GaugeMetricFamily("neuralmri_queue_depth", "Messages no worker has fetched.")
        waiting.add_metric([], depth)
        yield waiting
        alive = GaugeMetricFamily("neuralmri_live_workers", "Workers with a recent heartbeat.")
        alive.add_metric([], len(workers))
        yield alive

    def describe(self) -> Iterator[Metric]:
        """Nothing: registering must not ask Redis."""
        return iter(())


def metrics_route(registry: CollectorRegistry, access: JobAccess) -> APIRouter:
    """GET /metrics."""
    router = APIRouter(tags=["operation"])
    registry.register(JobMetrics(access))

    @router.get(
        "/metrics",
        response_class=Response,
        responses={200: {"content": {"text/plain": {}}}, **problems()},
    )
    def metrics() -> Response:
        """Prometheus text format."""
        return Response(generate_latest(registry), media_type=CONTENT_TYPE_LATEST)

    return router
