"""Every error leaves as an RFC 9457 problem document, whoever raised it."""

import errno
import logging
from collections.abc import Mapping
from typing import cast

from fastapi import FastAPI, Request
from fastapi.exceptions import RequestValidationError
from redis.exceptions import RedisError
from starlette.exceptions import HTTPException
from starlette.requests import ClientDisconnect
from starlette.responses import Response
from starlette.routing import compile_path

from jobs import log_context
from jobs.errors import JobGone
from schemas.problem import (
    Fault,
    InputError,
    InternalError,
    Problem,
    ProblemPart,
    ProblemType,
    ServiceError,
)
from service.keys.refused import KeyRefused
from service.route_template import method_and_route
from service.security_headers import SECURITY_HEADERS
from service.settings import ServiceSettings

MEDIA_TYPE = "application/problem+json"

log = logging.getLogger("neuralmri.service")

_OUR_FAULT = "the service failed; it is not your request's fault. Remedy: try again later."

_REMEDIES = {
    400: (ProblemType.INVALID_REQUEST, "Remedy: send the request as the API description says."),
    404: (ProblemType.NOT_FOUND, "there is nothing at this address. Remedy: see /openapi.json."),
    405: (
        ProblemType.METHOD_NOT_ALLOWED,
        "this address does not take this method. Remedy: use one that the Allow header lists.",
    ),
    413: (ProblemType.TOO_LARGE, "the request is too large. Remedy: send less at once."),
    415: (
        ProblemType.UNSUPPORTED_MEDIA_TYPE,
        "this media type is not accepted. Remedy: see the API description.",
    ),
    416: (
        ProblemType.UNSATISFIABLE_RANGE,
        "the file has no such bytes. Remedy: ask for a range within the length that the "
        "Content-Range header gives.",
    ),
}


class NotReadyError(InputError):
    """The job has no results now; `retry_after_s` is None where it never will."""

    def __init__(self, detail: str, retry_after_s: int | None) -> None:
        super().__init__(ProblemType.NOT_READY, detail, status=409, retry_after_s=retry_after_s)


def problem_response(problem: Problem, headers: Mapping[str, str] | None = None) -> Response:
    """The problem document as an answer, with the trace under which our log has it."""
    trace = log_context.current().trace
    problem = problem.model_copy(update={"trace_id": trace.trace_id if trace else None})
    return Response(
        problem.model_dump_json(exclude_none=True),
        status_code=problem.status,
        # Here too: an answer to a crash passes no middleware.
        headers={**SECURITY_HEADERS, **(headers or {})},
        media_type=MEDIA_TYPE,
    )


def problem_of_status(status: int, detail: str | None, instance: str) -> Problem:
    """The problem for an HTTP error of which only the status, and perhaps a sentence, is known."""
    internal = (ProblemType.INTERNAL, _OUR_FAULT)
    refused = (ProblemType.INVALID_REQUEST, "the request was refused.")
    type_, remedy = _REMEDIES.get(status, internal if status >= 500 else refused)
    family = InternalError if status >= 500 else InputError
    said = f"{detail.rstrip('.')}. {remedy}" if detail and status == 400 else remedy
    return family(type_, said, status=status).problem(instance)


def install_problem_handlers(app: FastAPI, settings: ServiceSettings) -> None:
    """Make `app` answer whatever its routes raise with a problem document."""
    again = {"Retry-After": str(settings.retry_after_s)}

    def service_error(request: Request, raised: Exception) -> Response:
        error = cast(ServiceError, raised)
        headers = again if error.status in (503, 507) else {}
        if error.status in (408, 413):  # the rest of the body is not read
            headers = {"Connection": "close"}
        if isinstance(error, KeyRefused):
            headers = {"WWW-Authenticate": error.challenge}
        if error.retry_after_s is not None:
            headers = {"Retry-After": str(error.retry_after_s)}
        if error.type is ProblemType.INTERNAL:
            log.error("%s %s: %s", *method_and_route(request.scope), error, exc_info=error)
        elif error.fault is Fault.SERVICE:
            why = repr(error.__cause__) if error.__cause__ else "no further cause"
            log.warning("%s %s: %s (%s)", *method_and_route(request.scope), error, why)
        return problem_response(error.problem(request.url.path), headers)

    def http_error(request: Request, raised: Exception) -> Response:
        error = cast(HTTPException, raised)
        problem = problem_of_status(error.status_code, str(error.detail), request.url.path)
        headers = dict(error.headers or {})
        if error.status_code == 405:  # Starlette lists the methods of the first route only
            headers["Allow"] = ", ".join(_allowed_methods(app, request.url.path))
        return problem_response(problem, headers)

    def invalid_parameters(request: Request, raised: Exception) -> Response:
        parts = [
            ProblemPart(pointer="/" + "/".join(map(str, e["loc"])), detail=e["msg"])
            for e in cast(RequestValidationError, raised).errors()
        ]
        found = InputError(
            ProblemType.INVALID_REQUEST,
            f"{parts[0].pointer}: {parts[0].detail}. Remedy: correct the parameters listed.",
            pointer=parts[0].pointer,
            errors=parts,
        )
        return problem_response(found.problem(request.url.path))

    def redis_error(request: Request, error: Exception) -> Response:
        unavailable = InternalError(
            ProblemType.UNAVAILABLE,
            "the job records cannot be reached. Remedy: try again later.",
            status=503,
        )
        unavailable.__cause__ = error
        return service_error(request, unavailable)

    def job_gone(request: Request, _error: Exception) -> Response:
        gone = InputError(
            ProblemType.NOT_FOUND, "the job was erased while you asked for it.", status=404
        )
        return service_error(request, gone)

    def storage_error(request: Request, error: Exception) -> Response:
        if cast(OSError, error).errno in (errno.ENOSPC, errno.EDQUOT):
            failure = InternalError(
                ProblemType.STORAGE_FULL,
                "the store is full; nothing was accepted. Remedy: erase jobs that are no longer "
                "needed (DELETE), or try again later.",
                status=507,
            )
        else:
            failure = InternalError(ProblemType.INTERNAL, _OUR_FAULT)
        failure.__cause__ = error
        return service_error(request, failure)

    def client_gone(_request: Request, _error: Exception) -> Response:
        # Its body stopped half way. Nobody reads the answer, and a log full of tracebacks would
        # be easily had.
        return Response(status_code=400)

    def unexpected(request: Request, error: Exception) -> Response:
        # Starlette raises it again for the server's log; the caller learns nothing about us.
        return problem_response(problem_of_status(500, None, request.url.path))

    app.add_exception_handler(ServiceError, service_error)
    app.add_exception_handler(HTTPException, http_error)
    app.add_exception_handler(RequestValidationError, invalid_parameters)
    app.add_exception_handler(RedisError, redis_error)
    app.add_exception_handler(JobGone, job_gone)
    app.add_exception_handler(OSError, storage_error)
    app.add_exception_handler(ClientDisconnect, client_gone)
    app.add_exception_handler(Exception, unexpected)


def _allowed_methods(app: FastAPI, path: str) -> list[str]:
    paths = app.openapi()["paths"]
    # `/v1/jobs/contours` would be a job's address too, of a job that cannot be.
    templates = [path] if path in paths else paths
    return sorted(
        method.upper()
        for template in templates
        if compile_path(template)[0].fullmatch(path)
        for method in paths[template]
    )
