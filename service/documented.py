"""What the API description says about problems: a response a status, with an example."""

from copy import deepcopy
from typing import Any

from schemas.problem import InputError, InternalError, ProblemType, ServiceError
from service.problems import MEDIA_TYPE

_EXAMPLES: dict[int, tuple[str, ServiceError]] = {
    400: (
        "The body is not what its media type says.",
        InputError(
            ProblemType.MALFORMED_JSON,
            "The body is not valid JSON: Expecting value at line 1 column 10. Remedy: write it "
            "with a JSON library, in UTF-8.",
            status=400,
        ),
    ),
    401: (
        "The service asks for an API key or a token, and none that is good came.",
        InputError(
            ProblemType.UNAUTHENTICATED,
            "this service asks for an API key. Remedy: send a key as `Authorization: Bearer ...`.",
            status=401,
        ),
    ),
    403: (
        "The key or token lacks the scope of this operation.",
        InputError(
            ProblemType.MISSING_SCOPE,
            "this key lacks the scope `submit`. Remedy: use a key made with --scope submit.",
            status=403,
        ),
    ),
    404: (
        "There is no such job, artifact or webhook.",
        InputError(ProblemType.NOT_FOUND, "there is no such job.", status=404),
    ),
    406: (
        "Accept excludes the only media type that there is.",
        InputError(
            ProblemType.NOT_ACCEPTABLE,
            "Accept excludes text/event-stream. Remedy: send Accept: text/event-stream.",
            status=406,
        ),
    ),
    409: (
        "The job has no results, not yet (with Retry-After) or never; the webhook is disabled.",
        InputError(
            ProblemType.NOT_READY,
            "the job is not finished. Remedy: poll it and come back when it has succeeded.",
            status=409,
        ),
    ),
    413: (
        "The request is too large.",
        InputError(
            ProblemType.TOO_LARGE,
            "the body has more than 33554432 bytes. Remedy: send fewer frames a job.",
            status=413,
        ),
    ),
    415: (
        "The body has another media type than the operation takes.",
        InputError(
            ProblemType.UNSUPPORTED_MEDIA_TYPE,
            "send the body as application/json.",
            status=415,
        ),
    ),
    416: (
        "The artifact has no such bytes.",
        InputError(ProblemType.UNSATISFIABLE_RANGE, "the file has no such bytes.", status=416),
    ),
    422: (
        "The request cannot be done as it stands; `pointer` says where.",
        InputError(
            ProblemType.IMPLAUSIBLE_SIZE,
            "The contours span 8.2e+04 mm; a heart spans 2 to 400 mm. Remedy: the coordinates look "
            'like micrometres: set units to "um".',
            pointer="/study/units",
        ),
    ),
    503: (
        "Nothing was accepted or changed; try again after Retry-After.",
        InternalError(
            ProblemType.UNAVAILABLE,
            "the queue cannot be reached; nothing was accepted, send the request again in a while",
            status=503,
        ),
    ),
    507: (
        "The store is full; nothing was accepted.",
        InternalError(ProblemType.STORAGE_FULL, "the store is full.", status=507),
    ),
}

_RETRY_AFTER = {
    "Retry-After": {"description": "Seconds to wait.", "schema": {"type": "integer", "minimum": 1}}
}

_CHALLENGE: dict[str, Any] = {
    "WWW-Authenticate": {
        "description": "`Bearer`, with an `error` and a `scope` (RFC 6750).",
        "schema": {"type": "string"},
    }
}


def problems(*statuses: int) -> dict[int | str, dict[str, Any]]:
    """The `responses` of an operation that can fail in these ways; every other is `default`."""
    described: dict[int | str, dict[str, Any]] = {
        status: described_problem(*_EXAMPLES[status], retry=status in (409, 503, 507))
        for status in statuses
    }
    internal = InternalError(ProblemType.INTERNAL, "the service failed. Remedy: try again later.")
    described["default"] = described_problem("Any other problem.", internal, retry=False)
    return described


def described_problem(description: str, example: ServiceError, *, retry: bool) -> dict[str, Any]:
    """One response: a problem, with `Retry-After` where `retry`."""
    described: dict[str, Any] = {
        "description": description,
        "content": {
            MEDIA_TYPE: {
                "schema": {"$ref": "#/components/schemas/Problem"},
                "example": example.problem("/v1/jobs").model_dump(mode="json", exclude_none=True),
            }
        },
    }
    if retry:
        described["headers"] = _RETRY_AFTER
    if example.status in (401, 403):
        described["headers"] = deepcopy(_CHALLENGE)  # YAML would make an anchor of it
    return described
