"""POST /v1/jobs/labels."""

from datetime import UTC, datetime

from fastapi import APIRouter, Response

from intake.inflate import is_gzip
from intake.work import label_work
from schemas.job import Job, JobKind
from schemas.messages import JobRequest
from service.acceptance import accept
from service.access import Access, Owner
from service.documented import problems
from service.held_answer import Answer
from service.label_submission import LABEL_BODY, LabelUpload, judge_labels
from service.submission_answers import SUBMISSION
from service.submission_terms import Terms

router = APIRouter(tags=["submit"])


@router.post(
    "/v1/jobs/labels",
    status_code=202,
    response_model=Job,
    responses={**SUBMISSION, **problems(400, 413, 415, 422, 503, 507)},
    openapi_extra=LABEL_BODY,
)
def submit_labels(
    upload: LabelUpload,
    access: Access,
    owner: Owner,
    terms: Terms,
    response: Response,
    answer: Answer,
) -> Job | Response:
    """Reconstruct surfaces from NIfTI label maps (.nii or .nii.gz), one file a view.

    The headers are judged, and the data counted, before the job is accepted; voxels are read by
    the worker. At least one label map is needed. Reference meshes may come beside them; a job
    whose maps turn out not to give the surface of a reference fails.
    """
    judged = judge_labels(upload, access.settings.limits())
    names = {
        view: f"{view}.nii.gz" if is_gzip(file) else f"{view}.nii"
        for view, file in judged.maps.items()
    }
    request = JobRequest(
        job_id=access.store.new_id(),
        kind=JobKind.LABELS,
        created_at=datetime.now(tz=UTC),
        priority=terms.priority,
        retain_s=terms.retain_s(access.settings),
        idempotency=terms.idempotency(JobKind.LABELS, upload),
        batch_id=terms.batch,
        name=terms.name,
        labels=judged.request,
        files=names,
        references=judged.references,
        work=label_work(judged.frames, judged.request.options),
    )
    inputs = {
        **{names[view]: file for view, file in judged.maps.items()},
        **{judged.references[surface]: file for surface, file in upload.references.items()},
    }
    job = accept(access, request, inputs, owner, response, reuse=terms.reuse)
    return answer(job, response, response.status_code or 202)
