"""POST /v1/jobs/labels."""

from datetime import UTC, datetime

from fastapi import APIRouter, Response

from intake.inflate import is_gzip
from jobs.submission import submit
from schemas.job import Job, JobKind
from schemas.messages import JobRequest
from service.accepted import ACCEPTED, announce
from service.access import Access, Owner
from service.documented import problems
from service.label_submission import LABEL_BODY, LabelUpload, judge_labels

router = APIRouter(tags=["submit"])


@router.post(
    "/v1/jobs/labels",
    status_code=202,
    responses={**ACCEPTED, **problems(400, 413, 415, 422, 503, 507)},
    openapi_extra=LABEL_BODY,
)
def submit_labels(
    upload: LabelUpload,
    access: Access,
    owner: Owner,
    response: Response,
) -> Job:
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
        labels=judged.request,
        files=names,
        references=judged.references,
    )
    inputs = {
        **{names[view]: file for view, file in judged.maps.items()},
        **{judged.references[surface]: file for surface, file in upload.references.items()},
    }
    job = submit(access.store, access.records, access.queue, request, inputs, owner)
    announce(job, response, access.settings)
    return job
