"""What happened to each job, in order: a capped Redis stream for each, written with its record.

An entry has the fields `event` (an EventKind), `data` (JSON) and, where it is the first that the
stream ever had, `begins`: a reader sees by it whether older entries were dropped.
"""

from redis.client import Pipeline

from jobs.record import Record
from schemas.event import EventKind

EVENT_CHANNEL = "neuralmri:events"
"""Where the id of a job is published with each of its events, so that readers need not ask."""

MAX_EVENTS = 1000
"""About how many a stream keeps: some minutes of progress at four a second, 200 KB."""

KEPT_AFTER_END_S = 3600
"""How long a stream outlives its job's end. The job folder tells the end for ever."""


def events_key(job_id: str) -> str:
    """Where a job's events are."""
    return f"neuralmri:job:{job_id}:events"


def add_event(pipe: Pipeline, before: Record | None, after: Record | None) -> None:
    """Queue the commands that tell of a step on a job's record, where there is something to tell.

    A renewed lease is not. A record that is forgotten takes its stream along.
    """
    if after is None:
        if before is not None:
            pipe.delete(events_key(before.job_id))
            pipe.publish(EVENT_CHANNEL, before.job_id)
        return
    told = _told(before, after)
    if told is None:
        return
    kind, data = told
    fields = {"event": kind.value, "data": data}
    if before is None:
        fields["begins"] = "1"
    key = events_key(after.job_id)
    pipe.xadd(key, fields, maxlen=MAX_EVENTS, approximate=True)  # type: ignore[arg-type]
    if after.state.is_terminal:
        pipe.expire(key, KEPT_AFTER_END_S)
    pipe.publish(EVENT_CHANNEL, after.job_id)


def _told(before: Record | None, after: Record) -> tuple[EventKind, str] | None:
    if before is None or (before.state, before.attempt) != (after.state, after.attempt):
        return EventKind.STATE, after.job().model_dump_json()
    if before.progress != after.progress:
        return EventKind.PROGRESS, after.progress.model_dump_json()
    return None
