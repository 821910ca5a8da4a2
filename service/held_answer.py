"""An answer that waits for its job's end, where the request prefers that: `Prefer: wait=N`.

No thread waits: the route has returned, and the files that came with a submission are closed.
"""

import asyncio
from collections.abc import Callable, Coroutine
from http import HTTPStatus
from typing import Annotated, Any

from fastapi import Depends, Response
from redis.exceptions import RedisError
from starlette.concurrency import run_in_threadpool
from starlette.types import Receive, Scope, Send

from jobs.cancelled_tasks import end_tasks
from schemas.job import Job
from schemas.problem import InputError
from service.access import Access, JobAccess
from service.listening import Listeners, Listening
from service.prefer import Prefer, preferred_wait_s

PREFERENCE_APPLIED: dict[str, Any] = {
    "Preference-Applied": {
        "description": "`wait=N` where the answer was held, N seconds at most.",
        "schema": {"type": "string"},
    }
}

JobAnswer = Callable[[Job, Response, int], Response]
"""Makes a route's answer from the job, the response that holds its headers, and its status."""


class HeldAnswer(Response):
    """The job as it is once it has ended, or once the time is up. Whoever hangs up ends the wait:
    nobody reads the answer then, but audit, log and metrics see what it would have been.

    Where Redis fails meanwhile, or a job that was just accepted is erased, it is told as it was:
    what was accepted is accepted. Where too many wait already, nothing is held, and the answer does
    not say that it was.
    """

    def __init__(
        self, job: Job, wait_s: int, announced: Response, access: JobAccess, listening: Listening
    ) -> None:
        super().__init__()
        self._job = job
        self._wait_s = wait_s
        self._announced = announced
        self._access = access
        self._listening = listening

    async def __call__(self, scope: Scope, receive: Receive, send: Send) -> None:
        job = self._job
        headers = dict(self._announced.headers)
        if self._listening.has_place(self._access.caller):
            with self._listening.place(self._access.caller):
                waiting = self._listening.until_ended(job.id, self._wait_s)
                stayed = await _ends_before_hang_up(waiting, receive)
            if stayed:
                headers["Preference-Applied"] = f"wait={self._wait_s}"
                job = await self._now()
        if job.state.is_terminal:
            headers.pop("retry-after", None)
        answer = Response(
            job.model_dump_json(),
            status_code=self._announced.status_code,
            headers=headers,
            media_type="application/json",
        )
        await answer(scope, receive, send)

    async def _now(self) -> Job:
        try:
            return await run_in_threadpool(self._access.job, self._job.id)
        except RedisError:
            return self._job
        except InputError:
            if self._announced.status_code == HTTPStatus.ACCEPTED:
                return self._job
            raise


async def job_answer(access: Access, listening: Listeners, prefer: Prefer = None) -> JobAnswer:
    """What a route returns its job through: held where the request prefers that and may be."""

    def answer(job: Job, response: Response, status: int) -> Response:
        wait_s = preferred_wait_s(prefer or [])
        if wait_s is None:
            # As a whole answer: a model would be validated and copied again, in another thread.
            return Response(
                job.model_dump_json(),
                status_code=status,
                headers=dict(response.headers),
                media_type="application/json",
            )
        response.status_code = status
        return HeldAnswer(job, min(wait_s, access.settings.max_wait_s), response, access, listening)

    return answer


Answer = Annotated[JobAnswer, Depends(job_answer)]


async def _ends_before_hang_up(waiting: Coroutine[Any, Any, None], receive: Receive) -> bool:
    ended = asyncio.create_task(waiting)
    hung_up = asyncio.create_task(_hang_up(receive))
    try:
        await asyncio.wait((ended, hung_up), return_when=asyncio.FIRST_COMPLETED)
        if ended.done():
            ended.result()  # raises what it raised
        return ended.done()
    finally:
        await end_tasks(ended, hung_up)


async def _hang_up(receive: Receive) -> None:
    while (await receive())["type"] != "http.disconnect":
        pass
