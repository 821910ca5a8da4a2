"""A client of the HTTP interface. A lost connection is no verdict on a job."""

import json
import time
import uuid
from collections.abc import Callable, Iterator, Sequence
from contextlib import ExitStack
from functools import partial
from pathlib import Path
from types import TracebackType
from typing import Any, Self, TypeVar
from urllib.parse import quote

import httpx
from pydantic import ValidationError

from cli.event_source import read_events
from cli.inputs import ContourInput, LabelInput
from cli.retrying import PASSING, TryAgain, persistently, retry_after_s
from cli.server_errors import ConnectionLostError, document_of, refusal_of
from cli.transfer import fetch
from schemas.artifacts import MANIFEST_NAME, Artifact, Manifest
from schemas.base import WireModel
from schemas.event import EVENT_STREAM, EventKind, JobEvent
from schemas.job import Job, JobPage, JobState, Progress
from schemas.messages import ContourRequest
from schemas.problem import InputError, InternalError, ProblemType, ServiceError
from schemas.report import Report

M = TypeVar("M", bound=WireModel)
T = TypeVar("T")

_CONTOURS = "/v1/jobs/contours"
_LABELS = "/v1/jobs/labels"

_DATA: dict[str, type[Job] | type[Progress]] = {
    EventKind.STATE: Job,
    EventKind.PROGRESS: Progress,
}
_TIMEOUT = httpx.Timeout(10.0, read=60.0, write=60.0)
_POLL_EVERY_S = 0.5
_PATIENCE_S = 300.0
_RETRY_WITHIN_S = 30.0


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
        self.server = server.rstrip("/")
        self.patience_s = patience_s
        self._retry_within_s = retry_within_s
        self._tell = tell
        # Environment proxies are for the outside; a local server is not reached through them.
        local = _parsed(self.server).host in ("127.0.0.1", "localhost", "::1")
        self._http = httpx.Client(
            base_url=self.server,
            headers={"Authorization": f"Bearer {_plain(api_key)}"} if api_key else {},
            timeout=_TIMEOUT,
            trust_env=not local,
        )

    def __enter__(self) -> Self:
        return self

    def __exit__(
        self,
        kind: type[BaseException] | None,
        error: BaseException | None,
        trace: TracebackType | None,
    ) -> None:
        self._http.close()

    def submit(self, given: ContourInput | LabelInput) -> Job:
        """Send a subject; once, however often the connection breaks on the way."""
        key = {"Idempotency-Key": uuid.uuid4().hex}
        if isinstance(given, ContourInput) and not given.references:
            body = given.request.model_dump(mode="json", exclude_unset=True)
            return self._submitted(lambda: self._ask("POST", _CONTOURS, json=body, headers=key))
        address = _CONTOURS if isinstance(given, ContourInput) else _LABELS
        request = given.request.model_dump_json(exclude_unset=True)

        def send() -> Any:
            # Files are opened anew for each attempt: the one before has read some of them.
            with ExitStack() as opened:
                parts: dict[str, Any] = {"request": (None, request, "application/json")}
                for name, path in _files_of(given).items():
                    file = opened.enter_context(path.open("rb"))
                    parts[name] = (path.name, file, "application/octet-stream")
                return self._ask("POST", address, files=parts, headers=key)

        return self._submitted(send)

    def job(self, job_id: str) -> Job:
        return _fitting(Job, self._call("GET", _address(job_id)))

    def jobs(
        self, state: JobState | None = None, limit: int = 50, cursor: str | None = None
    ) -> JobPage:
        """A page of the caller's jobs, newest first."""
        query = {"state": state and state.value, "limit": limit, "cursor": cursor}
        params = {name: value for name, value in query.items() if value is not None}
        return _fitting(JobPage, self._call("GET", "/v1/jobs", params=params))

    def cancel(self, job_id: str) -> Job:
        return _fitting(Job, self._call("POST", f"{_address(job_id)}/cancel"))

    def erase(self, job_id: str) -> None:
        """Remove a job with all it holds. One that is gone already is no error."""
        self._again(lambda: self._response("DELETE", _address(job_id)))

    def events(self, job_id: str, last_event_id: str = "") -> Iterator[JobEvent]:
        """The job's events after one, from one connection, to where it ends; see cli/following.py.

        Raises ConnectionLostError where it breaks off. Kinds that are not known are left out.
        """
        headers = {"Accept": EVENT_STREAM}
        if last_event_id:
            headers["Last-Event-ID"] = last_event_id
        try:
            with self._http.stream(
                "GET", f"{_address(job_id)}/events", headers=headers
            ) as response:
                if response.status_code == httpx.codes.NO_CONTENT:
                    return
                media_type = response.headers.get("content-type", "").partition(";")[0]
                if not response.is_success or media_type != EVENT_STREAM:
                    response.read()
                    raise refusal_of(response)
                for sent in read_events(response.iter_bytes(), last_event_id):
                    if sent.event in _DATA:
                        data = _fitting(_DATA[sent.event], _json_of(sent.data))
                        kind = EventKind(sent.event)
                        yield JobEvent(id=sent.last_event_id or None, event=kind, data=data)
        except httpx.TransportError as error:
            raise self._unreachable(error) from error

    def wait(self, job_id: str, watch: Callable[[Progress], None]) -> Job:
        """Poll until the job has ended, tell its progress, and return it. Raises as `poll`."""
        return self.poll(job_id, lambda job: watch(job.progress))

    def poll(self, job_id: str, watch: Callable[[Job], None]) -> Job:
        """Ask for the job until it has ended, and return it.

        A server that cannot be reached or fails is asked again for minutes. Raises InternalError
        when that does not help; the job may go on all the same.
        """
        silent_since_s: float | None = None
        while True:
            pause_s = _POLL_EVERY_S
            try:
                job = _fitting(Job, self._ask("GET", _address(job_id)))
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
        return _fitting(ContourRequest, self._call("GET", f"{_address(job_id)}/request"))

    def report(self, job_id: str) -> Report:
        return _fitting(Report, self._call("GET", f"{_address(job_id)}/report"))

    def download(self, job_id: str, out: Path, names: Sequence[str] = ()) -> Manifest:
        """Fetch artifacts into `out`, all or those named, and check length and SHA-256.

        A file takes its place only once it is whole; one that is there already is not fetched. What
        a broken line left is taken up again. Raises InternalError for a file that arrives damaged,
        InputError for a name that the job does not have.
        """
        manifest = _fitting(Manifest, self._call("GET", f"{_address(job_id)}/artifacts"))
        listed = {artifact.name: artifact for artifact in manifest.artifacts}
        unknown = [name for name in names if name not in listed]
        if unknown:
            raise InputError(
                ProblemType.NOT_FOUND,
                f"the job has no artifact {unknown[0]}; it has {', '.join(listed)}",
            )
        out.mkdir(parents=True, exist_ok=True)
        for name in names or listed:
            self._again(partial(self._fetch, job_id, listed[name], out))
        if not names:
            text = manifest.model_dump_json(indent=1)
            (out / MANIFEST_NAME).write_text(text, encoding="utf-8")
        return manifest

    def _fetch(self, job_id: str, artifact: Artifact, out: Path) -> None:
        path = f"{_address(job_id)}/artifacts/{artifact.name}"
        try:
            fetch(self._http, path, artifact, out, _refused)
        except httpx.TransportError as error:
            raise TryAgain(self._unreachable(error)) from error

    def get_as(self, model: type[M], method: str, path: str, **content: Any) -> M:
        """The answer to a call that may be made twice, as a model."""
        return _fitting(model, self._call(method, path, **content))

    def _submitted(self, send: Callable[[], Any]) -> Job:
        return _fitting(Job, self._again(send))

    def _call(self, method: str, path: str, **content: Any) -> Any:
        """The JSON that a call is answered with, made again where that may help."""
        return self._again(lambda: self._ask(method, path, **content))

    def _again(self, attempt: Callable[[], T]) -> T:
        return persistently(attempt, self._retry_within_s, self._tell)

    def _ask(self, method: str, path: str, **content: Any) -> Any:
        """The JSON that one call is answered with. Raises TryAgain too."""
        return document_of(self._response(method, path, **content))

    def _response(self, method: str, path: str, **content: Any) -> httpx.Response:
        try:
            response = self._http.request(method, path, **content)
        except httpx.UnsupportedProtocol as error:
            raise _no_address(self.server, error) from error
        except httpx.TransportError as error:
            raise TryAgain(self._unreachable(error)) from error
        if not response.is_success:
            raise _refused(response)
        return response

    def _unreachable(self, error: httpx.TransportError) -> ConnectionLostError:
        return ConnectionLostError(
            ProblemType.UNAVAILABLE,
            f"the server at {self.server} does not answer ({error}); start one with "
            "`neuralmri serve`, or name another with --server",
            status=503,
            is_silence=isinstance(error, httpx.ReadTimeout),
        )


def _refused(response: httpx.Response) -> TryAgain | ServiceError:
    """What to raise for an answer that is no success."""
    refusal, after_s = refusal_of(response), retry_after_s(response)
    # An attempt of ours whose answer was lost may still be on its way into the store.
    overtaken = response.status_code == 409 and "Idempotency-Key" in response.request.headers
    if response.status_code in PASSING or (overtaken and after_s is not None):
        return TryAgain(refusal, after_s)
    return refusal


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


def _plain(api_key: str) -> str:
    """The key as a header takes it. The complaint does not repeat it."""
    if not api_key.strip().isascii() or not api_key.strip().isprintable():
        raise InputError(
            ProblemType.INVALID_REQUEST,
            "the API key holds characters that no key has; give it whole and alone, as "
            "`neuralmri keys create` showed it",
        )
    return api_key.strip()


def _parsed(server: str) -> httpx.URL:
    try:
        return httpx.URL(server)
    except httpx.InvalidURL as error:
        raise _no_address(server, error) from error


def _no_address(server: str, error: Exception) -> InputError:
    return InputError(
        ProblemType.INVALID_REQUEST,
        f"{server!r} is no address ({error}); give one like http://127.0.0.1:8000",
    )


def _json_of(text: str) -> Any:
    try:
        return json.loads(text)
    except json.JSONDecodeError as error:
        raise InternalError(
            ProblemType.INTERNAL, "an event of the server is not JSON; is it a neuralmri server?"
        ) from error


def _fitting(model: type[M], document: Any) -> M:
    try:
        return model.model_validate(document)
    except ValidationError as error:
        raise InternalError(
            ProblemType.INTERNAL,
            f"the server answered with something else than a {model.__name__.lower()}; is it a "
            "neuralmri server, and of this version?",
        ) from error
