"""Requests, as the audit log has them: noted before the answer leaves, whatever route gave it."""

import logging
from datetime import UTC, datetime

from starlette.concurrency import run_in_threadpool
from starlette.datastructures import Headers
from starlette.types import ASGIApp, Message, Receive, Scope, Send

from jobs.batch_store import is_batch_id
from jobs.store import is_job_id
from schemas.audit import Action, AuditEntry, AuditOutcome
from service.audit_log import AuditLog
from service.keys.caller import Caller

_LOGGER = logging.getLogger("neuralmri.audit")

_DONE: dict[tuple[str, str], Action] = {
    ("POST", "/v1/jobs/contours"): Action.SUBMIT,
    ("POST", "/v1/jobs/labels"): Action.SUBMIT,
    ("POST", "/v1/jobs/files"): Action.SUBMIT,
    ("POST", "/v1/jobs/{job_id}/restart"): Action.SUBMIT,
    ("POST", "/v1/batches"): Action.SUBMIT,
    ("POST", "/v1/batches/contours"): Action.SUBMIT,
    ("POST", "/v1/batches/{batch_id}/cancel"): Action.CANCEL,
    ("DELETE", "/v1/batches/{batch_id}"): Action.ERASE,
    ("GET", "/v1/batches/{batch_id}/artifacts.zip"): Action.DOWNLOAD,
    ("GET", "/v1/jobs/{job_id}/artifacts.zip"): Action.DOWNLOAD,
    ("POST", "/v1/jobs/{job_id}/cancel"): Action.CANCEL,
    ("DELETE", "/v1/jobs/{job_id}"): Action.ERASE,
    ("GET", "/v1/jobs/{job_id}/request"): Action.DOWNLOAD,
    ("GET", "/v1/jobs/{job_id}/report"): Action.DOWNLOAD,
    ("GET", "/v1/jobs/{job_id}/artifacts/{name}"): Action.DOWNLOAD,
}
"""Operations that are always noted; of others, what was refused."""

_REFUSED = (401, 403, 404)
_NOTHING_SENT = 304


class Audited:
    """ASGI middleware. A line that the disk does not take goes to the service's own log instead."""

    def __init__(self, app: ASGIApp, log: AuditLog) -> None:
        self.app = app
        self.log = log

    async def __call__(self, scope: Scope, receive: Receive, send: Send) -> None:
        if scope["type"] != "http":
            await self.app(scope, receive, send)
            return

        async def send_noted(message: Message) -> None:
            if message["type"] == "http.response.start":
                await self._note(scope, message["status"], Headers(raw=message["headers"]))
            await send(message)

        try:
            await self.app(scope, receive, send_noted)
        except Exception:
            await self._note(scope, 500, Headers())
            raise

    async def _note(self, scope: Scope, status: int, headers: Headers) -> None:
        entry = _entry(scope, status, headers)
        if entry is not None:
            of_batch = scope.get("state", {}).get("jobs_of_batch", ())
            jobs = [entry.model_copy(update={"job": job_id}) for job_id in of_batch]
            await run_in_threadpool(self._write, [entry, *jobs])

    def _write(self, entries: list[AuditEntry]) -> None:
        for entry in entries:
            try:
                self.log.write(entry)
            except OSError as error:
                line = entry.model_dump_json(exclude_none=True)
                _LOGGER.error("the audit log takes no line (%r): %s", error, line)


def _entry(scope: Scope, status: int, headers: Headers) -> AuditEntry | None:
    """What is to be noted of a request; None for nothing."""
    route = getattr(scope.get("route"), "path", None)
    action = _DONE.get((scope["method"], route or ""))
    if route is None or status == _NOTHING_SENT or (action is None and status not in _REFUSED):
        return None
    state = scope.get("state", {})
    caller: Caller | None = state.get("caller")
    return AuditEntry(
        at=datetime.now(tz=UTC),
        actor=_actor(caller, state),
        owner=caller.owner if caller else None,
        action=action or (Action.READ if scope["method"] in ("GET", "HEAD") else Action.SUBMIT),
        outcome=_outcome(status),
        job=_job_id(scope, headers),
        status=status,
    )


def _actor(caller: Caller | None, state: dict[str, object]) -> str:
    if caller is None:
        return str(state.get("refused_actor") or "unknown")
    return caller.actor


def _outcome(status: int) -> AuditOutcome:
    if status < 400:
        return AuditOutcome.DONE
    return AuditOutcome.REFUSED if status in _REFUSED else AuditOutcome.FAILED


def _job_id(scope: Scope, headers: Headers) -> str | None:
    """The job or batch that was made, or the one in the address. Nothing that a caller made up."""
    made = headers.get("location", "").rpartition("/")[2]
    asked = scope.get("path_params", {})
    for named in (made, asked.get("job_id", ""), asked.get("batch_id", "")):
        if is_job_id(named) or is_batch_id(named):
            return str(named)
    return None
