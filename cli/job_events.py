"""A job's events from one connection, as they come."""

import json
from collections.abc import Iterator
from typing import Any

import httpx

from cli.connection import Connection
from cli.event_source import read_events
from cli.fitting import fitting
from cli.server_errors import refusal_of
from schemas.event import EVENT_STREAM, EventKind, JobEvent
from schemas.job import Job, Progress
from schemas.problem import InternalError, ProblemType

_DATA: dict[str, type[Job] | type[Progress]] = {
    EventKind.STATE: Job,
    EventKind.PROGRESS: Progress,
}


def job_events(connection: Connection, address: str, last_event_id: str = "") -> Iterator[JobEvent]:
    """The events at `address` after one, to where the connection ends; see cli/following.py.

    Raises ConnectionLostError where it breaks off. Kinds that are not known are left out.
    """
    headers = {"Accept": EVENT_STREAM}
    if last_event_id:
        headers["Last-Event-ID"] = last_event_id
    with connection.stream(address, headers) as response:
        if response.status_code == httpx.codes.NO_CONTENT:
            return
        media_type = response.headers.get("content-type", "").partition(";")[0]
        if not response.is_success or media_type != EVENT_STREAM:
            response.read()
            raise refusal_of(response)
        for sent in read_events(response.iter_bytes(), last_event_id):
            if sent.event in _DATA:
                data = fitting(_DATA[sent.event], _json_of(sent.data))
                kind = EventKind(sent.event)
                yield JobEvent(id=sent.last_event_id or None, event=kind, data=data)


def _json_of(text: str) -> Any:
    try:
        return json.loads(text)
    except json.JSONDecodeError as error:
        raise InternalError(
            ProblemType.INTERNAL, "an event of the server is not JSON; is it a neuralmri server?"
        ) from error
