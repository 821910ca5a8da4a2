"""A client of the HTTP interface. A lost connection is no verdict on a job."""

import hashlib
import time
from collections.abc import Callable
from contextlib import ExitStack
from pathlib import Path
from types import TracebackType
from typing import Any, Self, TypeVar

import httpx
from pydantic import ValidationError

from cli.inputs import ContourInput, LabelInput
from cli.server_errors import document_of, refusal_of
from schemas.artifacts import MANIFEST_NAME, Artifact, Manifest
from schemas.base import WireModel
from schemas.job import Job, Progress
from schemas.messages import ContourRequest
from schemas.problem import InputError, InternalError, ProblemType
from schemas.report import Report

M = TypeVar("M", bound=WireModel)

_TIMEOUT = httpx.Timeout(10.0, read=60.0, write=60.0)
_POLL_EVERY_S = 0.5
_PATIENCE_S = 300.0


class Client:
    """One server. Every method raises InputError or InternalError, as the server's problem says."""

    def __init__(self, server: str, patience_s: float = _PATIENCE_S) -> None:
        self.server = server.rstrip("/")
        self._patience_s = patience_s
        # Environment proxies are for the outside; a local server is not reached through them.
        local = _parsed(self.server).host in ("127.0.0.1", "localhost", "::1")
        self._http = httpx.Client(base_url=self.server, timeout=_TIMEOUT, trust_env=not local)

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
        """Send a subject. Not repeated on a lost connection: it may have been accepted."""
        if isinstance(given, ContourInput) and not given.references:
            body = given.request.model_dump(mode="json", exclude_unset=True)
            return _fitting(Job, self._call("POST", "/v1/jobs/contours", json=body))
        address = "/v1/jobs/contours" if isinstance(given, ContourInput) else "/v1/jobs/labels"
        request = given.request.model_dump_json(exclude_unset=True)
        with ExitStack() as opened:
            parts: dict[str, Any] = {"request": (None, request, "application/json")}
            for name, path in _files_of(given).items():
                file = opened.enter_context(path.open("rb"))
                parts[name] = (path.name, file, "application/octet-stream")
            return _fitting(Job, self._call("POST", address, files=parts))

    def job(self, job_id: str) -> Job:
        return _fitting(Job, self._call("GET", f"/v1/jobs/{job_id}"))

    def cancel(self, job_id: str) -> Job:
        return _fitting(Job, self._call("POST", f"/v1/jobs/{job_id}/cancel"))

    def wait(self, job_id: str, watch: Callable[[Progress], None]) -> Job:
        """Poll until the job has ended, and return it.

        A server that cannot be reached or fails is asked again for minutes. Raises InternalError
        when that does not help; the job may go on all the same.
        """
        silent_since_s: float | None = None
        while True:
            try:
                job = self.job(job_id)
            except InternalError as error:
                silent_since_s = silent_since_s or time.monotonic()
                if time.monotonic() - silent_since_s > self._patience_s:
                    raise InternalError(
                        ProblemType.UNAVAILABLE,
                        f"job {job_id} cannot be followed any more ({error.detail}); it may go on: "
                        f"look at {self.server}/v1/jobs/{job_id} later",
                    ) from error
            else:
                silent_since_s = None
                watch(job.progress)
                if job.state.is_terminal:
                    return job
            time.sleep(_POLL_EVERY_S)

    def request(self, job_id: str) -> ContourRequest:
        """What a contour job was asked. Raises InputError for one of label maps."""
        return _fitting(ContourRequest, self._call("GET", f"/v1/jobs/{job_id}/request"))

    def report(self, job_id: str) -> Report:
        return _fitting(Report, self._call("GET", f"/v1/jobs/{job_id}/report"))

    def download(self, job_id: str, out: Path) -> Manifest:
        """Fetch every artifact into `out` and check its length and SHA-256.

        A file takes its place only once it is whole. Raises InternalError for one that is not.
        """
        listed = self._call("GET", f"/v1/jobs/{job_id}/artifacts")
        manifest = _fitting(Manifest, listed)
        out.mkdir(parents=True, exist_ok=True)
        for artifact in manifest.artifacts:
            self._fetch(f"/v1/jobs/{job_id}/artifacts/{artifact.name}", artifact, out)
        (out / MANIFEST_NAME).write_text(manifest.model_dump_json(indent=1), encoding="utf-8")
        return manifest

    def _fetch(self, path: str, artifact: Artifact, out: Path) -> None:
        part = out / f".{artifact.name}.part"
        digest = hashlib.sha256()
        try:
            with self._http.stream("GET", path) as response, part.open("wb") as file:
                if not response.is_success:
                    response.read()
                    raise refusal_of(response)
                for chunk in response.iter_bytes():
                    digest.update(chunk)
                    file.write(chunk)
            if digest.hexdigest() != artifact.sha256:
                raise InternalError(
                    ProblemType.INTERNAL,
                    f"{artifact.name} arrived damaged (its SHA-256 is not the listed one); "
                    "download it again",
                )
            part.replace(out / artifact.name)
        except httpx.TransportError as error:
            raise self._unreachable(error) from error
        finally:
            part.unlink(missing_ok=True)

    def _call(self, method: str, path: str, **content: Any) -> Any:
        try:
            response = self._http.request(method, path, **content)
        except httpx.TransportError as error:
            raise self._unreachable(error) from error
        if not response.is_success:
            raise refusal_of(response)
        return document_of(response)

    def _unreachable(self, error: httpx.TransportError) -> InternalError:
        return InternalError(
            ProblemType.UNAVAILABLE,
            f"the server at {self.server} does not answer ({error}); start one with "
            "`neuralmri serve`, or name another with --server",
            status=503,
        )


def _files_of(given: ContourInput | LabelInput) -> dict[str, Path]:
    """What goes as a file, by the name of its part."""
    from intake.references import reference_part

    maps = given.files if isinstance(given, LabelInput) else {}
    references = {reference_part(surface): path for surface, path in given.references.items()}
    return {view.value: path for view, path in maps.items()} | references


def _parsed(server: str) -> httpx.URL:
    try:
        return httpx.URL(server)
    except httpx.InvalidURL as error:
        raise InputError(
            ProblemType.INVALID_REQUEST,
            f"{server!r} is no address ({error}); give one like http://127.0.0.1:8000",
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
