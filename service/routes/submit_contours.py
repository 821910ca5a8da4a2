"""POST /v1/jobs/contours."""

from datetime import UTC, datetime
from typing import Annotated, Any

from fastapi import APIRouter, Depends, Request, Response

from intake.contour_request import read_contour_request
from jobs.submission import submit
from schemas.job import Job, JobKind
from schemas.messages import JobRequest
from service.accepted import ACCEPTED, announce
from service.access import Access, Owner
from service.documented import problems
from service.examples import CONTOUR_REQUEST
from service.media_type import require_media_type

router = APIRouter(tags=["submit"])

_BODY: dict[str, Any] = {
    "requestBody": {
        "required": True,
        "content": {
            "application/json": {
                "schema": {"$ref": "#/components/schemas/ContourRequest"},
                "example": CONTOUR_REQUEST,
            }
        },
    }
}


async def _json_body(request: Request) -> bytes:
    require_media_type(request, "application/json")
    return await request.body()


@router.post(
    "/v1/jobs/contours",
    status_code=202,
    responses={**ACCEPTED, **problems(400, 413, 415, 422, 503, 507)},
    openapi_extra=_BODY,
)
def submit_contours(
    raw: Annotated[bytes, Depends(_json_body)], access: Access, owner: Owner, response: Response
) -> Job:
    """Reconstruct surfaces from contours.

    The study is judged before it is accepted; what is wrong with it is named by a JSON pointer.
    """
    contours, _ = read_contour_request(raw, access.settings.limits())
    request = JobRequest(
        job_id=access.store.new_id(),
        kind=JobKind.CONTOURS,
        created_at=datetime.now(tz=UTC),
        contours=contours,
    )
    job = submit(access.store, access.records, access.queue, request, {}, owner)
    announce(job, response, access.settings)
    return job
