"""POST /v1/jobs/contours."""

from datetime import UTC, datetime

from fastapi import APIRouter, Response

from intake.work import contour_work
from schemas.job import Job, JobKind
from schemas.messages import JobRequest
from service.acceptance import accept
from service.access import Access, Owner
from service.contour_submission import CONTOUR_BODY, ContourUpload, judge_contours
from service.documented import problems
from service.held_answer import Answer
from service.submission_answers import SUBMISSION
from service.submission_terms import Terms

router = APIRouter(tags=["submit"])


@router.post(
    "/v1/jobs/contours",
    status_code=202,
    response_model=Job,
    responses={**SUBMISSION, **problems(400, 413, 415, 422, 503, 507)},
    openapi_extra=CONTOUR_BODY,
)
def submit_contours(
    upload: ContourUpload,
    access: Access,
    owner: Owner,
    terms: Terms,
    response: Response,
    answer: Answer,
) -> Job | Response:
    """Reconstruct surfaces from contours.

    The study is judged before it is accepted; what is wrong with it is named by a JSON pointer.
    To have surfaces held against references, send a form: the study as part `request`, and each
    reference mesh as a file.
    """
    judged = judge_contours(upload, access.settings.limits())
    request = JobRequest(
        job_id=access.store.new_id(),
        kind=JobKind.CONTOURS,
        created_at=datetime.now(tz=UTC),
        priority=terms.priority,
        retain_s=terms.retain_s(access.settings),
        idempotency=terms.idempotency(JobKind.CONTOURS, upload),
        batch_id=terms.batch,
        name=terms.name,
        contours=judged.request,
        references=judged.references,
        work=contour_work(judged.request.study, judged.request.options),
    )
    inputs = {judged.references[surface]: file for surface, file in upload.references.items()}
    job = accept(access, request, inputs, owner, response, reuse=terms.reuse)
    return answer(job, response, response.status_code or 202)
