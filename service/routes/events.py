"""GET /v1/jobs/{id}/events."""

from collections.abc import AsyncIterator
from functools import partial
from typing import Annotated, Any

from fastapi import APIRouter, Depends, Header, Query, Request, Response
from fastapi.responses import StreamingResponse
from starlette.concurrency import run_in_threadpool

from jobs.event_id import START, EventId
from schemas.event import EVENT_STREAM
from schemas.problem import InputError, ProblemType
from service.accept import require_acceptable
from service.access import Access
from service.documented import described_problem, problems
from service.job_events import job_events, next_events
from service.keys.gate import Gate
from service.listening import Listeners

router = APIRouter(tags=["jobs"])

_EXAMPLE = """\
retry: 2000

event: state
data: {"id": "019...", "state": "running", "progress": {"fraction": 0.0, ...}, ...}
id: 1767323045000-0

event: progress
data: {"fraction": 0.41, "stage": "fitting", "frame": "ED", "level": 2, "iteration": 57, ...}
id: 1767323049250-0

: still here

event: state
data: {"id": "019...", "state": "succeeded", ...}
id: 1767323054000-0

"""
_ANSWERS: dict[int | str, dict[str, Any]] = {
    200: {
        "description": "Server-sent events. The `data` of `state` is a Job, that of `progress` a "
        "Progress, as JSON; the last event is a `state` in which the job has ended.",
        "content": {EVENT_STREAM: {"schema": {"type": "string"}, "example": _EXAMPLE}},
    },
    204: {
        "description": "Nothing follows `Last-Event-ID`: the job has ended and its end was "
        "told. An EventSource does not come back after this."
    },
    429: described_problem(
        "You follow as many jobs as you may.",
        InputError(
            ProblemType.TOO_MANY_LISTENERS,
            "you follow 50 jobs here already, as many as you may. Remedy: close a stream, or poll.",
            status=429,
        ),
        retry=True,
    ),
}


class EventStream(StreamingResponse):
    """FastAPI's own kind wants a generator for a route, which cannot answer 204."""

    media_type = EVENT_STREAM


async def _place(listening: Listeners, access: Access) -> AsyncIterator[None]:
    with listening.place(access.caller):
        yield


@router.get(
    "/v1/jobs/{job_id}/events",
    response_class=EventStream,
    responses={**_ANSWERS, **problems(404, 406, 503)},
    dependencies=[Depends(_place)],
)
async def job_event_stream(
    request: Request,
    job_id: str,
    access: Access,
    listening: Listeners,
    last_event_id: Annotated[
        str, Header(alias="Last-Event-ID", description="Go on after this event.")
    ] = "",
    last_event_id_query: Annotated[
        str,
        Query(
            alias="last_event_id",
            description="The same for clients that cannot set headers; the header counts first.",
        ),
    ] = "",
) -> Response:
    """Follow a job: its states and its progress as they happen.

    From the beginning, or after the event that `Last-Event-ID` names. An id of no event that is
    kept is answered by one `state` event, the job as it stands, and what follows; text that is no
    id counts as none.
    """
    require_acceptable(request, EVENT_STREAM)
    await run_in_threadpool(access.folder, job_id)
    after = EventId.of_text(last_event_id or last_event_id_query) or START
    batch = await next_events(job_id, after, access, listening)
    gate: Gate = request.app.state.gate
    if batch.is_last and not batch.events:
        return Response(status_code=204)
    return EventStream(
        job_events(job_id, after, access, listening, partial(gate.still_admits, access.caller)),
        headers={"Cache-Control": "no-store", "X-Accel-Buffering": "no"},
    )
