"""A client of the HTTP interface: what may be asked of a server about jobs and webhooks.

A lost connection is no verdict on a job.
"""

import time
import uuid
from collections.abc import Callable, Iterator, Mapping, Sequence
from contextlib import ExitStack
from pathlib import Path
from types import TracebackType
from typing import Any, Self
from urllib.parse import quote

from cli.artifact_files import fetch_artifacts
from cli.connection import Connection
from cli.fitting import M, fitting
from cli.inputs import ContourInput, LabelInput
from cli.job_events import job_events
from cli.retrying import TryAgain
from cli.webhook_calls import WebhookCalls
from schemas.artifacts import Manifest
from schemas.event import JobEvent
from schemas.job import Job, JobPage, JobState
from schemas.messages import ContourRequest
from schemas.problem import InternalError, ProblemType, ServiceError
from schemas.report import Report

_CONTOURS = "/v1/jobs/contours"
_LABELS = "/v1/jobs/labels"
_POLL_EVERY_S = 0.5
_PATIENCE_S = 300.0
_RETRY_WITHIN_S = 30.0

NO_TERMS: Mapping[str, str] = {}


class Client:
    """One server. Every method raises InputError or InternalError, as the server's problem says.

    A call that is not answered, or with "not now" (429, 503), is made again for `retry_within_s`;
    `tell` hears of it. Every call may be made twice: a submission carries an `Idempotency-Key`.
    """

    def __init__(
        self,
        server: str,
        api_key: str | None = None,
        patience_s: float = _PATIENCE_S,
        *,
        retry_within_s: float = _RETRY_WITHIN_S,
        tell: Callable[[str], None] = lambda _: None,
    ) -> None:
        self.patience_s = patience_s
        self.connection = Connection(server, api_key, retry_within_s, tell)
        self.webhooks = WebhookCalls(self.connection)

    @property
    def server(self) -> str:
        return self.connection.server

    def __enter__(self) -> Self:
        return self

    def __exit__(
        self,
        kind: type[BaseException] | None,
        error: BaseException | None,
        trace: TracebackType | None,
    ) -> None:
        self.connection.__exit__(kind, error, trace)

    def submit(self, given: ContourInput | LabelInput, terms: Mapping[str, str] = NO_TERMS) -> Job:
        """Send a subject; once, however often the connection breaks on the way.

        terms: query parameters, as `priority`.
        """
        how = {"params": dict(terms), "headers": {"Idempotency-Key": uuid.uuid4().hex}}
        if isinstance(given, ContourInput) and not given.references:
            body = given.request.model_dump(mode="json", exclude_unset=True)
            return self._submitted(lambda: self.connection.ask("POST", _CONTOURS, json=body, **how))
        address = _CONTOURS if isinstance(given, ContourInput) else _LABELS
        request = given.request.model_dump_json(exclude_unset=True)

        def send() -> Any:
            # Files are opened anew for each attempt: the one before has read some of them.
            with ExitStack() as opened:
                parts: dict[str, Any] = {"request": (None, request, "application/json")}
                for name, path in _files_of(given).items():
                    file = opened.enter_context(path.open("rb"))
                    parts[name] = (path.name, file, "application/octet-stream")
                return self.connection.ask("POST", address, files=parts, **how)

        return self._submitted(send)

    def job(self, job_id: str) -> Job:
        return fitting(Job, self.connection.call("GET", _address(job_id)))

    def jobs(
        self, state: JobState | None = None, limit: int = 50, cursor: str | None = None
    ) -> JobPage:
        """A page of the caller's jobs, newest first."""
        query = {"state": state and state.value, "limit": limit, "cursor": cursor}
        params = {name: value for name, value in query.items() if value is not None}
        return fitting(JobPage, self.connection.call("GET", "/v1/jobs", params=params))

    def cancel(self, job_id: str, *, keeps_frames: bool = False) -> Job:
        query = "?keep_frames=true" if keeps_frames else ""
        return fitting(Job, self.connection.call("POST", f"{_address(job_id)}/cancel{query}"))

    def erase(self, job_id: str) -> None:
        """Remove a job with all it holds. One that is gone already is no error."""
        self.connection.do("DELETE", _address(job_id))

    def events(self, job_id: str, last_event_id: str = "") -> Iterator[JobEvent]:
        """The job's events after one, from one connection, as `job_events` has them."""
        return job_events(self.connection, f"{_address(job_id)}/events", last_event_id)

    def poll(self, job_id: str, watch: Callable[[Job], None]) -> Job:
        """Ask for the job until it has ended, and return it.

        A server that cannot be reached or fails is asked again for minutes. Raises InternalError
        when that does not help; the job may go on all the same.
        """
        silent_since_s: float | None = None
        while True:
            pause_s = _POLL_EVERY_S
            try:
                job = fitting(Job, self.connection.ask("GET", _address(job_id)))
            except (TryAgain, InternalError) as raised:
                pause_s = max(pause_s, getattr(raised, "after_s", None) or 0.0)
                error = raised.error if isinstance(raised, TryAgain) else raised
                silent_since_s = silent_since_s or time.monotonic()
                if time.monotonic() - silent_since_s > self.patience_s:
                    raise self.cannot_follow(job_id, error) from raised
            else:
                silent_since_s = None
                watch(job)
                if job.state.is_terminal:
                    return job
            time.sleep(pause_s)

    def cannot_follow(self, job_id: str, error: ServiceError) -> InternalError:
        """What to raise when the server has failed for longer than `patience_s`."""
        return InternalError(
            ProblemType.UNAVAILABLE,
            f"job {job_id} cannot be followed any more ({error.detail}); it may go on: "
            f"look at {self.server}/v1/jobs/{job_id} later",
        )

    def request(self, job_id: str) -> ContourRequest:
        """What a contour job was asked. Raises InputError for one of label maps."""
        return fitting(ContourRequest, self.connection.call("GET", f"{_address(job_id)}/request"))

    def report(self, job_id: str) -> Report:
        return fitting(Report, self.connection.call("GET", f"{_address(job_id)}/report"))

    def download(self, job_id: str, out: Path, names: Sequence[str] = ()) -> Manifest:
        """Fetch artifacts into `out`, as `fetch_artifacts` does."""
        return fetch_artifacts(self.connection, f"{_address(job_id)}/artifacts", out, names)

    def get_as(self, model: type[M], method: str, path: str, **content: Any) -> M:
        """The answer to a call that may be made twice, as a model."""
        return fitting(model, self.connection.call(method, path, **content))

    def _submitted(self, send: Callable[[], Any]) -> Job:
        return fitting(Job, self.connection.again(send))


def _address(job_id: str) -> str:
    """Of a job, or of a batch."""
    kind = "batches" if job_id.startswith("bt_") else "jobs"
    return f"/v1/{kind}/{quote(job_id, safe='')}"


def _files_of(given: ContourInput | LabelInput) -> dict[str, Path]:
    """What goes as a file, by the name of its part."""
    from intake.references import reference_part

    maps = given.files if isinstance(given, LabelInput) else {}
    references = {reference_part(surface): path for surface, path in given.references.items()}
    return {view.value: path for view, path in maps.items()} | references
