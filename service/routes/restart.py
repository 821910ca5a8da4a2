"""POST /v1/jobs/{job_id}/restart."""

import json
from typing import Annotated, Any

from fastapi import APIRouter, Depends, Request, Response

from intake.json_body import parse_json
from intake.limits import Limits
from intake.references import check_reference_surfaces
from intake.study import admit
from intake.work import contour_work, rescaled
from jobs.restart import again, options_of, stored_inputs
from schemas.job import Job
from schemas.messages import JobRequest
from schemas.options import Options
from schemas.restart import RestartedOptions, RestartRequest, changed_options
from service.acceptance import accept
from service.access import Access
from service.documented import problems
from service.form_upload import FormUpload
from service.held_answer import Answer
from service.media_type import require_media_type
from service.problems import NotReadyError
from service.submission_answers import SUBMISSION
from service.submission_terms import Terms

router = APIRouter(tags=["jobs"])

_JSON = "application/json"
_BODY: dict[str, Any] = {
    "requestBody": {
        "required": False,
        "content": {
            _JSON: {
                "schema": {"$ref": "#/components/schemas/RestartRequest"},
                "example": {"options": {"seed": 1, "mesh": {"grid_mm": 1.0}}},
            }
        },
    }
}


async def _change(request: Request, access: Access) -> RestartRequest:
    raw = await request.body()
    if not raw:
        return RestartRequest()
    require_media_type(request, _JSON)
    return parse_json(raw, RestartRequest, access.settings.limits())


@router.post(
    "/v1/jobs/{job_id}/restart",
    status_code=202,
    response_model=Job,
    responses={**SUBMISSION, **problems(400, 404, 409, 413, 415, 422, 503, 507)},
    openapi_extra=_BODY,
)
def restart_job(
    job_id: str,
    change: Annotated[RestartRequest, Depends(_change)],
    access: Access,
    terms: Terms,
    response: Response,
    answer: Answer,
) -> Job | Response:
    """Do an ended job anew, as a new job, from the inputs that are stored: nothing is sent again.

    The job itself stays as it is. Options that the body names replace the job's; of a group, those
    that it names within the group. With another preset, what the old one had filled in changes.
    Whoever asks, the new job belongs to the owner of the old one.
    """
    folder = access.folder(job_id)
    if folder.outcome() is None:
        raise NotReadyError(
            "the job is not at its end, and only an ended one is done anew. Remedy: wait for its "
            "end, or cancel it first.",
            access.settings.poll_after_s,
        )
    old = folder.request()
    limits = access.settings.limits()
    named = json.dumps({"options": changed_options(options_of(old), change)}).encode()
    options = parse_json(named, RestartedOptions, limits).options
    change_of = json.dumps({"restarted_from": job_id, "options": change.options}).encode()
    request = again(old, access.store.new_id(), options).model_copy(
        update={
            "priority": terms.priority,
            "batch_id": terms.batch,
            "name": terms.name,
            "retain_s": terms.retain_s(access.settings),
            "idempotency": terms.idempotency(old.kind, FormUpload(change_of)),
            "work": _work(old, options),
        }
    )
    _judge(request, limits)
    inputs = stored_inputs(folder, old)
    job = accept(access, request, inputs, old.owner, response, reuse=terms.reuse)
    return answer(job, response, response.status_code or 202)


def _work(old: JobRequest, options: Options) -> float:
    if old.contours is not None:
        return contour_work(old.contours.study, options)
    return rescaled(old.work, options_of(old), options)


def _judge(request: JobRequest, limits: Limits) -> None:
    """Hold what was admitted once against its new options. Raises InputError."""
    if request.contours is not None:
        study, options = request.contours.study, request.contours.options
        admit(study, options, limits)
        check_reference_surfaces(study, options, request.references)
