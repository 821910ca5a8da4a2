"""What this process knows without Redis: the room in the job store, and what it was built from."""

import platform
import shutil
from collections.abc import Iterator
from importlib.metadata import version
from pathlib import Path

from prometheus_client.core import GaugeMetricFamily, Metric
from prometheus_client.registry import Collector

from jobs.quarantine import Quarantine


class HostMetrics(Collector):
    """The file system of the job store, left out where it cannot be asked, and the build."""

    def __init__(self, jobs_dir: Path) -> None:
        self._jobs_dir = jobs_dir

    def collect(self) -> Iterator[Metric]:
        up = GaugeMetricFamily("neuralmri_store_up", "Whether the job store can be asked.")
        try:
            usage = shutil.disk_usage(self._jobs_dir)
            quarantined = Quarantine(self._jobs_dir).count()
        except OSError:
            up.add_metric([], 0.0)
        else:
            up.add_metric([], 1.0)
            size = GaugeMetricFamily("neuralmri_store_size_bytes", "Of the store's file system.")
            size.add_metric([], usage.total)
            yield size
            free = GaugeMetricFamily("neuralmri_store_free_bytes", "Left for the service's user.")
            free.add_metric([], usage.free)
            yield free
            odd = GaugeMetricFamily("neuralmri_quarantined_folders", "What was no job.")
            odd.add_metric([], quarantined)
            yield odd
        yield up
        build = GaugeMetricFamily("neuralmri_build_info", "Always 1.", labels=["version", "python"])
        build.add_metric([version("neuralmri"), platform.python_version()], 1.0)
        yield build

    def describe(self) -> Iterator[Metric]:
        """Nothing: registering must not ask the disk."""
        return iter(())
