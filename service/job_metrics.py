"""Jobs, queue and workers in figures, read from Redis when asked."""

import time
from collections.abc import Iterator

from prometheus_client.core import (
    CounterMetricFamily,
    GaugeMetricFamily,
    HistogramMetricFamily,
    Metric,
)
from prometheus_client.registry import Collector
from redis.exceptions import RedisError

from jobs.store import made_at_s
from jobs.tallies import Totals
from schemas.job import JobState
from service.access import JobAccess


class JobMetrics(Collector):
    """Of all services and workers on one Redis: any one service's answer is the whole."""

    def __init__(self, access: JobAccess) -> None:
        self._access = access

    def collect(self) -> Iterator[Metric]:
        up = GaugeMetricFamily("neuralmri_redis_up", "Whether Redis answers.")
        try:
            found = [*self._now(), *_since(self._access.tallies.totals())]
        except RedisError:
            found = []
        up.add_metric([], float(bool(found)))
        yield up
        yield from found

    def describe(self) -> Iterator[Metric]:
        """Nothing: registering must not ask Redis."""
        return iter(())

    def _now(self) -> Iterator[Metric]:
        """How things stand."""
        access = self._access
        jobs = GaugeMetricFamily("neuralmri_jobs", "Jobs by state.", labels=["state"])
        for state, count in access.records.counts().items():
            jobs.add_metric([state.value], count)
        yield jobs
        yield _gauge(
            "neuralmri_queue_depth", "Messages no worker has fetched.", access.queue.depth()
        )
        oldest = access.records.oldest(JobState.QUEUED)
        yield _gauge(
            "neuralmri_oldest_queued_job_age_seconds",
            "How long ago the oldest queued job was accepted; 0 without one.",
            max(0.0, time.time() - made_at_s(oldest)) if oldest else 0.0,
        )
        yield _gauge(
            "neuralmri_live_workers", "Workers with a recent heartbeat.", len(access.live_workers())
        )
        yield _gauge(
            "neuralmri_work_done",
            "Whether a worker holds a job, or finished a heartbeat of late.",
            float(access.is_work_done()),
        )


def _since(totals: Totals) -> Iterator[Metric]:
    """What has happened since Redis began."""
    ended = CounterMetricFamily(
        "neuralmri_jobs_ended",
        "Jobs that ended; of failed ones, whose fault it was.",
        labels=["kind", "state", "fault"],
    )
    for labels, count in sorted(totals.ended.items()):
        ended.add_metric(labels, count)
    yield ended
    attempts = CounterMetricFamily("neuralmri_attempts", "Attempts begun by workers.")
    attempts.add_metric([], totals.attempts)
    yield attempts
    lost = CounterMetricFamily(
        "neuralmri_workers_lost", "Attempts whose worker fell silent while it held the job."
    )
    lost.add_metric([], totals.workers_lost)
    yield lost
    expired = CounterMetricFamily("neuralmri_jobs_expired", "Jobs erased when they had expired.")
    expired.add_metric([], totals.expired)
    yield expired
    stages = HistogramMetricFamily(
        "neuralmri_stage_duration_seconds",
        "Time that jobs spent in each stage, and waiting for their first worker.",
        labels=["stage"],
    )
    for stage, durations in sorted(totals.stages.items()):
        stages.add_metric([stage], durations.cumulative(), durations.total_s)
    yield stages


def _gauge(name: str, meaning: str, value: float) -> Metric:
    gauge = GaugeMetricFamily(name, meaning)
    gauge.add_metric([], value)
    return gauge
