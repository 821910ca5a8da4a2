"""Waiting for jobs without a thread: what event streams and held answers share in one process."""

import asyncio
import time
from collections import Counter
from collections.abc import Iterator
from contextlib import AsyncExitStack, contextmanager
from types import TracebackType
from typing import Annotated, Self

from fastapi import Depends, Request
from redis.exceptions import RedisError

from jobs.event_bell import EventBell
from jobs.event_reader import EventReader
from jobs.redis_client import make_async_redis
from schemas.problem import InputError, InternalError, ProblemType
from service.keys.caller import Caller
from service.settings import ServiceSettings
from service.stop_signal import on_stop_signal


class Listening:
    """Who waits, how many at most, and what wakes them. An async context, one a process.

    It takes a handful of Redis connections, whatever the number of listeners.
    """

    def __init__(self, settings: ServiceSettings) -> None:
        self.heartbeat_s = settings.event_heartbeat_s
        self.is_stopping = False
        self._max_listeners = settings.max_listeners
        self._max_of_owner = settings.max_listeners_per_owner
        self._of_owner: Counter[str | None] = Counter()
        self._retry_after_s = settings.retry_after_s
        self._redis = make_async_redis(settings.redis_url, settings.redis_timeout_s)
        self.reader = EventReader(self._redis)
        self.bell = EventBell(self._redis)
        self._open = AsyncExitStack()

    async def __aenter__(self) -> Self:
        self._open.push_async_callback(self._redis.aclose)
        await self._open.enter_async_context(self.bell)
        self._open.enter_context(on_stop_signal(self.stop))
        return self

    async def __aexit__(
        self,
        kind: type[BaseException] | None,
        error: BaseException | None,
        trace: TracebackType | None,
    ) -> None:
        self.stop()
        await self._open.aclose()

    def stop(self) -> None:
        """Have everybody stop waiting: the server closes."""
        self.is_stopping = True
        self.bell.ring_all()

    def has_place(self, caller: Caller) -> bool:
        """Whether one more may listen, and this caller one more time."""
        return not self._is_full and not self._is_full_for(caller)

    @contextmanager
    def place(self, caller: Caller) -> Iterator[None]:
        """Count as a listener.

        Raises InternalError (unavailable, 503) where there are too many, InputError (too many
        listeners, 429) where too many of them are the caller's owner's.
        """
        if self._is_full:
            raise InternalError(
                ProblemType.UNAVAILABLE,
                f"{self._max_listeners} callers follow jobs here already. Remedy: poll the job, or "
                "try again later.",
                status=503,
            )
        if self._is_full_for(caller):
            raise InputError(
                ProblemType.TOO_MANY_LISTENERS,
                f"you follow {self._max_of_owner} jobs here already, as many as you may. Remedy: "
                "close a stream, or poll the job.",
                status=429,
                retry_after_s=self._retry_after_s,
            )
        self._of_owner[_share(caller)] += 1
        try:
            yield
        finally:
            self._of_owner[_share(caller)] -= 1
            self._of_owner += Counter()  # drops who has none

    @property
    def _is_full(self) -> bool:
        return self._of_owner.total() >= self._max_listeners

    def _is_full_for(self, caller: Caller) -> bool:
        share = _share(caller)
        return share is not None and self._of_owner[share] >= self._max_of_owner

    async def until_ended(self, job_id: str, within_s: float) -> None:
        """Return when the job has ended or is gone, when time is up, or when the server stops."""
        deadline_s = time.monotonic() + within_s
        with self.bell.waiter(job_id) as waiter:
            while not self.is_stopping and (left_s := deadline_s - time.monotonic()) > 0.0:
                try:
                    async with asyncio.timeout(left_s):
                        state = await self.reader.state(job_id)
                except (RedisError, TimeoutError):
                    pass  # it may be back in time; what is known is answered if not
                else:
                    if state is None or state.is_terminal:
                        return
                await waiter.wait(min(self.heartbeat_s, max(0.0, deadline_s - time.monotonic())))


def _share(caller: Caller) -> str | None:
    """Whose share of the places a caller takes; nobody's where no keys are asked for."""
    return caller.owner if caller.is_named else None


async def listening_of(request: Request) -> Listening:
    """The process's listeners."""
    listening: Listening = request.app.state.listening
    return listening


Listeners = Annotated[Listening, Depends(listening_of)]
