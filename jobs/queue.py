"""The queue as its producer sees it: put a message in, and look at what waits there."""

import json
from typing import cast

from celery import Celery
from kombu.exceptions import KombuError, OperationalError
from redis import Redis
from redis.exceptions import RedisError

from jobs.batch_turn import give_batch_turn
from jobs.celery_settings import celery_settings
from jobs.settings import JobSettings
from schemas.messages import (
    HEARTBEAT_QUEUE,
    HEARTBEAT_TASK,
    QUEUES,
    RECONSTRUCT_TASK,
    ReconstructMessage,
)
from schemas.problem import InternalError, ProblemType


class JobQueue:
    """A Celery producer that knows the task by name only, so the science is never imported."""

    def __init__(self, settings: JobSettings, redis: Redis) -> None:
        self._redis = redis
        self._app = Celery("neuralmri-producer", set_as_current=False)
        shared = celery_settings(settings)
        self._app.conf.update(shared)
        # A worker waits for Redis to come back; whoever sends a request does not.
        self._app.conf.broker_transport_options = {
            **shared["broker_transport_options"],
            "max_retries": 1,
            "interval_start": 0,
            "interval_step": 0.1,
            "interval_max": 0.1,
            "connect_retries_timeout": settings.redis_timeout_s,
        }

    def enqueue(self, message: ReconstructMessage) -> None:
        """Send a message to the queue of its priority.

        Raises InternalError (unavailable, 503) where Redis does not take it.
        The message's id is the job's, so that `waiting` can tell whose messages are there.
        """
        try:
            self._app.send_task(
                RECONSTRUCT_TASK,
                kwargs=message.as_kwargs(),
                headers=message.as_headers(),
                task_id=message.job_id,
                queue=QUEUES[message.priority],
                retry=False,
                ignore_result=True,
            )
        except (OperationalError, KombuError, RedisError, OSError) as error:
            raise InternalError(
                ProblemType.UNAVAILABLE,
                "the queue cannot be reached; nothing was accepted, try again in a while",
                status=503,
            ) from error

    def ask_for_heartbeat(self) -> None:
        """Send a heartbeat for any worker to finish, unless one waits.

        It does not expire: hosts may have wrong clocks, and one finished late proves as much.

        Raises RedisError, or an error of kombu, where Redis does not take it.
        """
        if self._redis.llen(HEARTBEAT_QUEUE) == 0:
            self._app.send_task(
                HEARTBEAT_TASK,
                queue=HEARTBEAT_QUEUE,
                retry=False,
                ignore_result=True,
            )

    def waiting(self) -> set[str]:
        """Ids of the jobs that have a message no worker has fetched yet."""
        with self._redis.pipeline() as pipe:  # at one instant: a message may change queues
            for name in QUEUES.values():
                pipe.lrange(name, 0, -1)
            queues = cast(list[list[str]], pipe.execute())
        return {json.loads(message)["headers"]["id"] for queue in queues for message in queue}

    def give_batch_turn(self, every_s: float) -> bool:
        """Let the oldest batch job go next: see `batch_turn`."""
        return give_batch_turn(self._redis, every_s)

    def depth(self) -> int:
        """How many messages no worker has fetched yet."""
        with self._redis.pipeline() as pipe:
            for name in QUEUES.values():
                pipe.llen(name)
            return sum(pipe.execute())
