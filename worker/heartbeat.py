"""The worker's sign of life, from the loop that takes jobs: when that hangs, it falls silent.

The loop alone does not finish a job, so from time to time it also sends a heartbeat through the
queue, for a child to finish (`worker/heartbeat_task.py`).
"""

import logging
from dataclasses import dataclass
from typing import Any

from celery import bootsteps
from celery.worker.consumer.tasks import Tasks
from kombu.exceptions import KombuError
from redis.exceptions import RedisError

from jobs.live_workers import LiveWorkers
from jobs.queue import JobQueue
from jobs.redis_client import make_redis
from schemas.messages import HEARTBEAT_QUEUE
from worker.settings import WorkerSettings

_LOGGER = logging.getLogger(__name__)


@dataclass(frozen=True)
class _Pulse:
    """What a beat does."""

    workers: LiveWorkers
    queue: JobQueue
    settings: WorkerSettings
    code_version: str

    def beat(self, worker_name: str, slots: int) -> None:
        """Say that this worker is alive; ask for a heartbeat where the last one is some time ago.

        Of all workers together: one that is finished is enough for a while.
        """
        try:
            self.workers.heartbeat(worker_name, slots, self.code_version)
            ago_s = self.workers.heartbeat_finished_ago_s()
            if ago_s is None or ago_s >= self.settings.heartbeat_within_s / 2:
                self.queue.ask_for_heartbeat()
        except (RedisError, KombuError, OSError) as error:
            _LOGGER.warning("the heartbeat was not recorded: %s", error)


def heartbeat_step(settings: WorkerSettings, code_version: str) -> type[bootsteps.StartStopStep]:
    """A step of Celery's consumer that beats while the consumer is connected and taking tasks."""
    redis = make_redis(settings.redis_url, settings.redis_timeout_s)
    pulse = _Pulse(LiveWorkers(redis), JobQueue(settings, redis), settings, code_version)

    class Heartbeat(bootsteps.StartStopStep):  # type: ignore[misc]  # celery ships no types
        """Beats once at the start and then every few seconds, until the consumer stops."""

        requires = (Tasks,)

        def __init__(self, consumer: Any, **options: Any) -> None:
            super().__init__(consumer, **options)
            self._timer_entry: Any = None

        def start(self, consumer: Any) -> None:
            # Whatever queues of jobs the command line names.
            consumer.add_task_queue(HEARTBEAT_QUEUE)
            said = (consumer.hostname, consumer.controller.concurrency)
            pulse.beat(*said)
            self._timer_entry = consumer.timer.call_repeatedly(
                settings.heartbeat_every_s, pulse.beat, said
            )

        def stop(self, consumer: Any) -> None:
            if self._timer_entry is not None:
                consumer.timer.cancel(self._timer_entry)
                self._timer_entry = None

    return Heartbeat
