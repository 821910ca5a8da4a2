"""Following a job to its end: by its event stream, and by polling where there is none to be had."""

import time
from collections.abc import Callable

from cli.client import Client
from cli.server_errors import ConnectionLostError
from schemas.event import EventKind, JobEvent
from schemas.job import Job, Progress
from schemas.problem import ServiceError

_AGAIN_AFTER_S = 1.0

Tell = Callable[[JobEvent], None]


def wait_for(client: Client, job_id: str, watch: Callable[[Progress], None]) -> Job:
    """Follow a job to its end, tell how far it is, and return it. Raises as `follow`."""
    return follow(client, job_id, lambda event: watch(progress_of(event)))


def progress_of(event: JobEvent) -> Progress:
    """How far the job is, by what an event says."""
    return event.data.progress if isinstance(event.data, Job) else event.data


def follow(client: Client, job_id: str, tell: Tell) -> Job:
    """Tell each event of a job as it comes, and return the job once it has ended.

    A lost connection is made anew, and goes on where the old one broke off. A server that has no
    stream, or none for us now, is polled. Raises InputError for a job that there is not, and
    InternalError where the server stays away for minutes; the job may go on all the same.
    """
    last_event_id = ""
    lost_since_s: float | None = None
    while True:
        try:
            has_heard = False
            for event in client.events(job_id, last_event_id):
                has_heard, lost_since_s = True, None
                last_event_id = event.id or last_event_id
                tell(event)
                if isinstance(event.data, Job) and event.data.state.is_terminal:
                    return event.data
            # It ended without the job's end: the server stops, or has told us all there is.
            if not has_heard and (job := client.job(job_id)).state.is_terminal:
                return job
        except ConnectionLostError as error:
            lost_since_s = lost_since_s or time.monotonic()
            if time.monotonic() - lost_since_s > client.patience_s:
                raise client.cannot_follow(job_id, error) from error
            if error.is_silence and not last_event_id:
                break  # something between us holds the stream back
        except ServiceError:
            break  # polling tells whether it is the job or the stream that is not to be had
        time.sleep(_AGAIN_AFTER_S)
    return _poll(client, job_id, tell)


def _poll(client: Client, job_id: str, tell: Tell) -> Job:
    seen: Job | None = None

    def watch(job: Job) -> None:
        nonlocal seen
        if seen is None or (seen.state, seen.attempt) != (job.state, job.attempt):
            tell(JobEvent(id=None, event=EventKind.STATE, data=job))
        elif seen.progress != job.progress:
            tell(JobEvent(id=None, event=EventKind.PROGRESS, data=job.progress))
        seen = job

    return client.poll(job_id, watch)
