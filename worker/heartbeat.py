"""The worker's sign of life, from the loop that takes jobs: when that hangs, it falls silent."""

import logging
from typing import Any

from celery import bootsteps
from celery.worker.consumer.tasks import Tasks
from redis.exceptions import RedisError

from jobs.live_workers import LiveWorkers
from jobs.redis_client import make_redis
from worker.settings import WorkerSettings

_LOGGER = logging.getLogger(__name__)


def heartbeat_step(settings: WorkerSettings) -> type[bootsteps.StartStopStep]:
    """A step of Celery's consumer that beats while the consumer is connected and taking tasks."""
    workers = LiveWorkers(make_redis(settings.redis_url, settings.redis_timeout_s))

    class Heartbeat(bootsteps.StartStopStep):  # type: ignore[misc]  # celery ships no types
        """Beats once at the start and then every few seconds, until the consumer stops."""

        requires = (Tasks,)

        def __init__(self, consumer: Any, **options: Any) -> None:
            super().__init__(consumer, **options)
            self._timer_entry: Any = None

        def start(self, consumer: Any) -> None:
            said = (workers, consumer.hostname, consumer.controller.concurrency)
            _beat(*said)
            self._timer_entry = consumer.timer.call_repeatedly(
                settings.heartbeat_every_s, _beat, said
            )

        def stop(self, consumer: Any) -> None:
            if self._timer_entry is not None:
                consumer.timer.cancel(self._timer_entry)
                self._timer_entry = None

    return Heartbeat


def _beat(workers: LiveWorkers, worker_name: str, slots: int) -> None:
    try:
        workers.heartbeat(worker_name, slots)
    except RedisError as error:
        _LOGGER.warning("the heartbeat was not recorded: %s", error)
