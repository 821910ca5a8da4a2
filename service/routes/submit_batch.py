"""POST /v1/batches and /v1/batches/contours."""

from dataclasses import dataclass
from typing import Annotated, Any

from fastapi import APIRouter, Depends, Request, Response

from jobs.estimate import retry_after_s
from schemas.batch import Batch, BatchRecord
from service.access import Access, JobAccess, Owner
from service.batches.reading import JSON, LINES, read_batch
from service.batches.submission import accept_batch
from service.batches.terms import Terms
from service.batches.view import batch_of
from service.documented import problems
from service.examples import CONTOUR_REQUEST
from service.media_type import require_media_type
from service.submission_answers import SUBMISSION

router = APIRouter(tags=["batches"])

_EXAMPLE = {
    "studies": [{"name": "case-01", "study": CONTOUR_REQUEST["study"]}],
    "options": CONTOUR_REQUEST["options"],
}
_BODY: dict[str, Any] = {
    "requestBody": {
        "required": True,
        "content": {
            JSON: {
                "schema": {"$ref": "#/components/schemas/BatchRequest"},
                "example": _EXAMPLE,
            },
            LINES: {
                "schema": {
                    "type": "string",
                    "description": "One BatchStudy a line, as JSON. A line that is not JSON is "
                    "refused alone.",
                }
            },
        },
    }
}
_ACCEPTED: dict[int | str, dict[str, Any]] = {
    202: {
        "description": "The batch is stored, and of its studies each is accepted, and will be "
        "done, or refused with a problem of its own.",
        "headers": {
            "Location": {"description": "The batch.", "schema": {"type": "string"}},
            "Retry-After": {
                "description": "Seconds to wait before the first look.",
                "schema": {"type": "integer", "minimum": 1},
            },
            "Idempotency-Replayed": {
                "description": "`true` where the batch was made by the same request before.",
                "schema": {"type": "string", "const": "true"},
            },
        },
    },
    409: SUBMISSION[409],
    429: SUBMISSION[429],
}


@dataclass(frozen=True)
class _Received:
    body: bytes
    media_type: str


async def _received(request: Request) -> _Received:
    media_type = require_media_type(request, JSON, LINES)
    return _Received(await request.body(), media_type)


@router.post("/v1/batches", status_code=202, responses={**_ACCEPTED, **problems(422, 503, 507)})
def open_batch(access: Access, owner: Owner, terms: Terms, response: Response) -> Batch:
    """Make an empty batch. Submissions of any kind join it by `?batch=` and its id."""
    idempotency = terms.idempotency(b"", in_lines=False)
    record, replayed = accept_batch(access, list, owner, terms, idempotency)
    return _answer(access, record, response, replayed=replayed)


@router.post(
    "/v1/batches/contours",
    status_code=202,
    responses={**_ACCEPTED, **problems(400, 413, 415, 422, 503, 507)},
    openapi_extra=_BODY,
)
def submit_batch(
    request: Request,
    received: Annotated[_Received, Depends(_received)],
    access: Access,
    owner: Owner,
    terms: Terms,
    response: Response,
) -> Batch:
    """Reconstruct surfaces from many contour studies, each a job of its own.

    Every study is judged, and accepted or refused, by itself, in the order of the body; pointers of
    refusals lead into the body, where line N of one in lines is `/studies/N-1`. Where none is
    accepted, nothing is kept and the answer is a problem.
    """
    limits, most = access.settings.limits(), access.settings.max_batch_studies
    body = read_batch(received.body, received.media_type, limits, most)
    idempotency = terms.idempotency(received.body, in_lines=received.media_type == LINES)
    record, replayed = accept_batch(access, lambda: body.judged(limits), owner, terms, idempotency)
    request.state.jobs_of_batch = record.job_ids
    return _answer(access, record, response, replayed=replayed)


def _answer(access: JobAccess, record: BatchRecord, response: Response, *, replayed: bool) -> Batch:
    batch = batch_of(access, record)
    response.headers["Location"] = batch.links.self
    again_s = retry_after_s(access.line.next_start_s(), access.settings.poll_after_s)
    response.headers["Retry-After"] = str(again_s)
    if replayed:
        response.headers["Idempotency-Replayed"] = "true"
    return batch
