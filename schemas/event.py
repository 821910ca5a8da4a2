"""What a job's event stream tells: one event, and which kinds there are."""

from enum import StrEnum

from schemas.base import WireModel
from schemas.job import Job, Progress

EVENT_STREAM = "text/event-stream"


class EventKind(StrEnum):
    """The `event` field of a server-sent event; it says what `data` is."""

    STATE = "state"
    """The job entered a state, or a worker began it anew; `data` is the job."""
    PROGRESS = "progress"
    """The job came further; `data` is its progress."""


class JobEvent(WireModel):
    """One event of a job. `id` is None where no stream gave it."""

    id: str | None
    event: EventKind
    data: Job | Progress
