"""A bell for each job that somebody waits for, rung when something happens to the job.

One connection listens for all of a process's waiters. What happened is not in the ring: whoever is
woken reads it. So a ring too many costs a look, and one that was lost is made good by the ring for
everybody after each new connection.
"""

import asyncio
import logging
from collections import defaultdict
from collections.abc import Iterator
from contextlib import contextmanager
from types import TracebackType
from typing import Any, Self, cast

from redis.asyncio import Redis
from redis.exceptions import ConnectionError as RedisConnectionError
from redis.exceptions import RedisError

from jobs.cancelled_tasks import end_tasks
from jobs.event_stream import EVENT_CHANNEL

_LOGGER = logging.getLogger(__name__)
_CHECK_EVERY_S = 5.0
_RETRY_EVERY_S = 0.5


class Waiter:
    """One who waits for something to happen to a job."""

    def __init__(self) -> None:
        self._rung = asyncio.Event()

    def ring(self) -> None:
        self._rung.set()

    async def wait(self, within_s: float) -> bool:
        """Whether it rang since the last wait, or does within that time."""
        try:
            async with asyncio.timeout(within_s):
                await self._rung.wait()
        except TimeoutError:
            return False
        self._rung.clear()
        return True


class EventBell:
    """Listens from entering to leaving the `async with` block, also while Redis is away."""

    def __init__(self, redis: Redis) -> None:
        self._redis = redis
        self._waiters: defaultdict[str, set[Waiter]] = defaultdict(set)
        self._task: asyncio.Task[None] | None = None
        self._is_deaf = False

    async def __aenter__(self) -> Self:
        self._task = asyncio.create_task(self._run(), name="event-bell")
        return self

    async def __aexit__(
        self,
        kind: type[BaseException] | None,
        error: BaseException | None,
        trace: TracebackType | None,
    ) -> None:
        if self._task is not None:
            await end_tasks(self._task)

    @contextmanager
    def waiter(self, job_id: str) -> Iterator[Waiter]:
        """Be woken for a job for as long as the block lasts."""
        waiter = Waiter()
        self._waiters[job_id].add(waiter)
        try:
            yield waiter
        finally:
            self._waiters[job_id].discard(waiter)
            if not self._waiters[job_id]:
                del self._waiters[job_id]

    def ring_all(self) -> None:
        for waiters in self._waiters.values():
            for waiter in waiters:
                waiter.ring()

    async def _run(self) -> None:
        while True:
            try:
                await self._listen()
            except (RedisError, OSError) as error:
                if not self._is_deaf:  # once an outage
                    _LOGGER.warning("events are not heard, Redis cannot be reached: %s", error)
                self._is_deaf = True
            await asyncio.sleep(_RETRY_EVERY_S)

    async def _listen(self) -> None:
        """Ring for each event. Raises RedisError where the connection is lost, or silent."""
        async with self._redis.pubsub() as channel:
            await channel.subscribe(EVENT_CHANNEL)
            is_asked = False
            while True:
                message = await channel.get_message(timeout=_CHECK_EVERY_S)
                if message is None:
                    if is_asked:
                        raise RedisConnectionError("no answer to a ping")
                    await cast(Any, channel).ping()
                elif message["type"] == "subscribe":
                    self._is_deaf = False
                    self.ring_all()
                elif message["type"] == "message":
                    for waiter in self._waiters.get(message["data"], ()):
                        waiter.ring()
                is_asked = message is None
