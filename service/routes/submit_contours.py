"""POST /v1/jobs/contours."""

from collections.abc import AsyncIterator
from datetime import UTC, datetime
from typing import Annotated, Any

from fastapi import APIRouter, Depends, Request, Response

from intake.contour_request import read_contour_request
from intake.references import check_reference_surfaces, judge_references
from jobs.submission import submit
from schemas.job import Job, JobKind
from schemas.messages import JobRequest
from service.accepted import ACCEPTED, announce
from service.access import Access, Owner
from service.documented import problems
from service.examples import CONTOUR_REQUEST
from service.form_description import form_content
from service.form_upload import FORM, FormUpload, received_form
from service.held_answer import Answer
from service.media_type import require_media_type

router = APIRouter(tags=["submit"])

_JSON = "application/json"
_BODY: dict[str, Any] = {
    "requestBody": {
        "required": True,
        "content": {
            _JSON: {
                "schema": {"$ref": "#/components/schemas/ContourRequest"},
                "example": CONTOUR_REQUEST,
            },
            FORM: form_content("ContourRequest", {}),
        },
    }
}


async def _upload(request: Request, access: Access) -> AsyncIterator[FormUpload]:
    """The body: JSON alone, or a form of the same JSON and reference meshes."""
    if require_media_type(request, _JSON, FORM) == _JSON:
        yield FormUpload(await request.body())
        return
    limits = access.settings.limits()
    async with received_form(
        request, (), limits, max_json_bytes=limits.max_request_bytes
    ) as upload:
        yield upload


@router.post(
    "/v1/jobs/contours",
    status_code=202,
    response_model=Job,
    responses={**ACCEPTED, **problems(400, 413, 415, 422, 503, 507)},
    openapi_extra=_BODY,
)
def submit_contours(
    upload: Annotated[FormUpload, Depends(_upload, scope="function")],
    access: Access,
    owner: Owner,
    response: Response,
    answer: Answer,
) -> Job | Response:
    """Reconstruct surfaces from contours.

    The study is judged before it is accepted; what is wrong with it is named by a JSON pointer.
    To have surfaces held against references, send a form: the study as part `request`, and each
    reference mesh as a file.
    """
    limits = access.settings.limits()
    contours, _ = read_contour_request(upload.request, limits)
    check_reference_surfaces(contours.study, contours.options, upload.references)
    references = judge_references(upload.references, limits)
    request = JobRequest(
        job_id=access.store.new_id(),
        kind=JobKind.CONTOURS,
        created_at=datetime.now(tz=UTC),
        contours=contours,
        references=references,
    )
    inputs = {references[surface]: file for surface, file in upload.references.items()}
    job = submit(access.store, access.records, access.queue, request, inputs, owner)
    announce(job, response, access.settings)
    return answer(job, response, 202)
