"""What this process knows without Redis: the room in the job store, and what it was built from."""

import platform
from collections.abc import Iterator
from importlib.metadata import version

from prometheus_client.core import GaugeMetricFamily, Metric
from prometheus_client.registry import Collector

from jobs.store import JobStore
from jobs.store_errors import StoreUnavailable


class HostMetrics(Collector):
    """The room in the job store, left out where it has no bound or cannot be asked; the build."""

    def __init__(self, store: JobStore) -> None:
        self._store = store

    def collect(self) -> Iterator[Metric]:
        up = GaugeMetricFamily("neuralmri_store_up", "Whether the job store can be asked.")
        try:
            space = self._store.space()
            quarantined = self._store.quarantined()
        except (OSError, StoreUnavailable):
            up.add_metric([], 0.0)
            space = None
        else:
            up.add_metric([], 1.0)
            odd = GaugeMetricFamily("neuralmri_quarantined_folders", "What was no job.")
            odd.add_metric([], quarantined)
            yield odd
        if space is not None:
            size = GaugeMetricFamily("neuralmri_store_size_bytes", "Of the store's file system.")
            size.add_metric([], space.total_bytes)
            yield size
            free = GaugeMetricFamily("neuralmri_store_free_bytes", "Left for the service's user.")
            free.add_metric([], space.free_bytes)
            yield free
        yield up
        build = GaugeMetricFamily("neuralmri_build_info", "Always 1.", labels=["version", "python"])
        build.add_metric([version("neuralmri"), platform.python_version()], 1.0)
        yield build

    def describe(self) -> Iterator[Metric]:
        """Nothing: registering must not ask the store."""
        return iter(())
