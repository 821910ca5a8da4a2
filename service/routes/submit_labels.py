"""POST /v1/jobs/labels."""

from datetime import UTC, datetime
from typing import Annotated, Any

from fastapi import APIRouter, Depends, Response

from intake.inflate import is_gzip
from intake.json_body import parse_json
from intake.label_maps import check_label_maps
from jobs.submission import submit
from schemas.job import Job, JobKind
from schemas.labels import LabelRequest
from schemas.messages import JobRequest
from service.accepted import ACCEPTED, announce
from service.access import Access, Owner
from service.documented import problems
from service.label_upload import FILE_VIEWS, LabelUpload, receive_label_upload

router = APIRouter(tags=["submit"])

_FILE = {"type": "string", "contentMediaType": "application/octet-stream"}
_BODY: dict[str, Any] = {
    "requestBody": {
        "required": True,
        "content": {
            "multipart/form-data": {
                "schema": {
                    "type": "object",
                    "required": ["request"],
                    "additionalProperties": False,
                    "properties": {
                        "request": {"$ref": "#/components/schemas/LabelRequest"},
                        **{
                            view.value: {**_FILE, "description": f"NIfTI label map of {view}."}
                            for view in FILE_VIEWS
                        },
                    },
                },
                "encoding": {"request": {"contentType": "application/json"}},
            }
        },
    }
}


@router.post(
    "/v1/jobs/labels",
    status_code=202,
    responses={**ACCEPTED, **problems(400, 413, 415, 422, 503, 507)},
    openapi_extra=_BODY,
)
def submit_labels(
    upload: Annotated[LabelUpload, Depends(receive_label_upload)],
    access: Access,
    owner: Owner,
    response: Response,
) -> Job:
    """Reconstruct surfaces from NIfTI label maps (.nii or .nii.gz), one file a view.

    The headers are judged, and the data counted, before the job is accepted; voxels are read by
    the worker. At least one file is needed.
    """
    limits = access.settings.limits()
    labels = parse_json(upload.request, LabelRequest, limits)
    check_label_maps(upload.files, labels, limits)
    names = {
        view: f"{view}.nii.gz" if is_gzip(file) else f"{view}.nii"
        for view, file in upload.files.items()
    }
    request = JobRequest(
        job_id=access.store.new_id(),
        kind=JobKind.LABELS,
        created_at=datetime.now(tz=UTC),
        labels=labels,
        files=names,
    )
    inputs = {names[view]: file for view, file in upload.files.items()}
    job = submit(access.store, access.records, access.queue, request, inputs, owner)
    announce(job, response, access.settings)
    return job
