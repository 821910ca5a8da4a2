"""POST /v1/jobs/files."""

from datetime import UTC, datetime

from fastapi import APIRouter, Response

from intake.work import contour_work
from schemas.job import Job, JobKind
from schemas.messages import JobRequest
from service.acceptance import accept
from service.access import Access, Owner
from service.documented import problems
from service.file_submission import FILES_BODY, FilesUpload, judge_files
from service.held_answer import Answer
from service.submission_answers import SUBMISSION
from service.submission_terms import Terms

router = APIRouter(tags=["submit"])


@router.post(
    "/v1/jobs/files",
    status_code=202,
    response_model=Job,
    responses={**SUBMISSION, **problems(400, 413, 415, 422, 503, 507)},
    openapi_extra=FILES_BODY,
)
def submit_files(
    upload: FilesUpload,
    access: Access,
    owner: Owner,
    terms: Terms,
    response: Response,
    answer: Answer,
) -> Job | Response:
    """Reconstruct surfaces from contour files of other programs.

    They are read into a contour study here, and the job is a contour job from there on:
    `GET /v1/jobs/{job_id}/request` gives the study. What was guessed, mended or left out in
    reading stands among the warnings of the report. The files themselves are not kept.
    """
    judged = judge_files(upload, access.settings.limits())
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
