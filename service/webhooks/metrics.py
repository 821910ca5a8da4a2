"""Webhooks in figures: what waits, since when, and how attempts went."""

import threading
from collections.abc import Iterator
from datetime import UTC, datetime

from prometheus_client.core import CounterMetricFamily, GaugeMetricFamily, Metric
from prometheus_client.registry import Collector

from service.webhooks.attempt_counts import AttemptCounts
from service.webhooks.endpoints import Endpoints
from service.webhooks.outbox import Outbox
from service.webhooks.outbox_index import OutboxIndex


class WebhookMetrics(Collector):
    """Messages are of the data folder: any one service's answer is the whole. Attempts are those
    of this process, and the service that dispatches makes them.
    """

    def __init__(self, endpoints: Endpoints, outbox: Outbox, attempts: AttemptCounts) -> None:
        self._endpoints = endpoints
        self._index = OutboxIndex(outbox)
        self._attempts = attempts
        self._one_at_a_time = threading.Lock()

    def collect(self) -> Iterator[Metric]:
        with self._one_at_a_time:
            yield from self._waiting(datetime.now(UTC))
        attempts = CounterMetricFamily(
            "neuralmri_webhook_attempts",
            "Attempts at messages; of messages, how many were given up.",
            labels=["result"],
        )
        for result, count in self._attempts.totals().items():
            attempts.add_metric([result], count)
        yield attempts

    def describe(self) -> Iterator[Metric]:
        """Nothing: registering must not ask the disk."""
        return iter(())

    def _waiting(self, now: datetime) -> Iterator[Metric]:
        every = self._endpoints.all()
        enabled = {endpoint.id for endpoint in every if endpoint.disabled_at is None}
        self._index.keep(enabled)
        seen = [seen for id_ in enabled for seen in self._index.of(id_).values()]
        waiting = [(s.created_at, s.next_at) for s in seen if s.next_at is not None]
        endpoints = GaugeMetricFamily(
            "neuralmri_webhook_endpoints", "Registered endpoints.", labels=["state"]
        )
        endpoints.add_metric(["enabled"], len(enabled))
        endpoints.add_metric(["disabled"], len(every) - len(enabled))
        yield endpoints
        for name, meaning, value in (
            ("pending", "Messages to enabled endpoints that wait.", float(len(waiting))),
            (
                "oldest_pending_age_seconds",
                "How long ago the oldest of them was made; 0 without one.",
                _since_s(now, [made_at for made_at, _ in waiting]),
            ),
            (
                "overdue_seconds",
                "How long ago the next attempt at one of them was due; 0 where none is.",
                _since_s(now, [next_at for _, next_at in waiting]),
            ),
        ):
            gauge = GaugeMetricFamily(f"neuralmri_webhook_{name}", meaning)
            gauge.add_metric([], value)
            yield gauge


def _since_s(now: datetime, instants: list[datetime]) -> float:
    return max(0.0, (now - min(instants)).total_seconds()) if instants else 0.0
