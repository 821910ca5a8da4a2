"""Readiness in figures: what GET /readyz would say."""

from collections.abc import Iterator

from prometheus_client.core import GaugeMetricFamily, Metric
from prometheus_client.registry import Collector

from service.access import JobAccess
from service.readiness import missing
from service.tokens.keys_at_hand import KeysAtHand

_PARTS = ("issuer", "redis", "store", "workers")


class ReadinessMetrics(Collector):
    """One gauge a part, so that an alert can say which one it is."""

    def __init__(self, access: JobAccess, issuer_keys: KeysAtHand) -> None:
        self._access = access
        self._issuer_keys = issuer_keys

    def collect(self) -> Iterator[Metric]:
        failing = {part.pointer for part in missing(self._access, self._issuer_keys)}
        ready = GaugeMetricFamily(
            "neuralmri_ready",
            "Whether this part is ready; a service is when all of them are.",
            labels=["part"],
        )
        for part in sorted(failing.union(_PARTS)):
            ready.add_metric([part], float(part not in failing))
        yield ready

    def describe(self) -> Iterator[Metric]:
        """Nothing: registering must not ask Redis."""
        return iter(())
