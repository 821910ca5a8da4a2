"""One job's event stream, for one listener, for as long as either lasts."""

import logging
import time
from collections.abc import AsyncIterator, Callable

from redis.exceptions import RedisError
from starlette.concurrency import run_in_threadpool

from jobs.event_id import EventId
from jobs.event_reader import EventBatch
from schemas.problem import InputError
from service.access import JobAccess
from service.event_text import HEARTBEAT, REDIS_AWAY, event_text, retry_text
from service.listening import Listening

_LOGGER = logging.getLogger(__name__)
_LOOK_EVERY_S = 2.0
"""How long a stream may go on whose listener's key was called back, or whose token ended."""


async def job_events(
    job_id: str,
    after: EventId,
    access: JobAccess,
    listening: Listening,
    still_admitted: Callable[[], bool],
) -> AsyncIterator[bytes]:
    """The job's events after one, as they come, until the job has ended or is erased.

    It ends too when the server stops, and within seconds when the listener would not be let in any
    more. It outlives an outage of Redis: a browser would not come back after a 503. Where Redis has
    lost the job it is restored from its folder.
    """
    yield retry_text(access.settings.poll_after_s)
    with listening.bell.waiter(job_id) as waiter:
        while not listening.is_stopping and await run_in_threadpool(still_admitted):
            try:
                batch = await next_events(job_id, after, access, listening)
            except RedisError as error:
                _LOGGER.info("job %s: its events cannot be read: %s", job_id, error)
                yield REDIS_AWAY
            except InputError:
                return  # erased
            else:
                for event in batch.events:
                    yield event_text(event)
                    after = event.id
                if batch.is_last:
                    return
                if not batch.is_whole:
                    continue
            silent_until_s = time.monotonic() + listening.heartbeat_s
            while not await waiter.wait(min(_LOOK_EVERY_S, listening.heartbeat_s)):
                if not await run_in_threadpool(still_admitted):
                    return
                if time.monotonic() >= silent_until_s:
                    yield HEARTBEAT
                    break


async def next_events(
    job_id: str, after: EventId, access: JobAccess, listening: Listening
) -> EventBatch:
    """What happened after an event. Raises RedisError, or InputError for a job that is not there.

    Redis alone is asked, unless it does not know the job.
    """
    while (batch := await listening.reader.read(job_id, after)) is None:
        await run_in_threadpool(access.job, job_id)
    return batch
