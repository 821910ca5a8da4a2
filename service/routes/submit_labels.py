"""POST /v1/jobs/labels."""

from collections.abc import AsyncIterator
from datetime import UTC, datetime
from typing import Annotated, Any

from fastapi import APIRouter, Depends, Request, Response

from intake.inflate import is_gzip
from intake.json_body import parse_json
from intake.label_maps import check_label_maps
from intake.references import judge_references
from jobs.submission import submit
from schemas.job import Job, JobKind
from schemas.labels import LabelRequest
from schemas.messages import JobRequest
from schemas.vocabulary import View
from service.accepted import ACCEPTED, announce
from service.access import Access, Owner
from service.documented import problems
from service.form_description import form_content
from service.form_upload import FORM, FormUpload, received_form
from service.held_answer import Answer
from service.media_type import require_media_type

router = APIRouter(tags=["submit"])

_VIEWS = (View.SAX, View.LAX_2CH, View.LAX_3CH, View.LAX_4CH)
_MAX_JSON_BYTES = 1 << 20
_BODY: dict[str, Any] = {
    "requestBody": {
        "required": True,
        "content": {
            FORM: form_content(
                "LabelRequest", {view.value: f"NIfTI label map of {view}." for view in _VIEWS}
            )
        },
    }
}


async def _upload(request: Request, access: Access) -> AsyncIterator[FormUpload]:
    require_media_type(request, FORM)
    async with received_form(
        request, _VIEWS, access.settings.limits(), max_json_bytes=_MAX_JSON_BYTES
    ) as upload:
        yield upload


@router.post(
    "/v1/jobs/labels",
    status_code=202,
    response_model=Job,
    responses={**ACCEPTED, **problems(400, 413, 415, 422, 503, 507)},
    openapi_extra=_BODY,
)
def submit_labels(
    upload: Annotated[FormUpload, Depends(_upload, scope="function")],
    access: Access,
    owner: Owner,
    response: Response,
    answer: Answer,
) -> Job | Response:
    """Reconstruct surfaces from NIfTI label maps (.nii or .nii.gz), one file a view.

    The headers are judged, and the data counted, before the job is accepted; voxels are read by
    the worker. At least one label map is needed. Reference meshes may come beside them; a job
    whose maps turn out not to give the surface of a reference fails.
    """
    limits = access.settings.limits()
    labels = parse_json(upload.request, LabelRequest, limits)
    maps = {View(name): file for name, file in upload.files.items()}
    check_label_maps(maps, labels, limits)
    references = judge_references(upload.references, limits)
    names = {
        view: f"{view}.nii.gz" if is_gzip(file) else f"{view}.nii" for view, file in maps.items()
    }
    request = JobRequest(
        job_id=access.store.new_id(),
        kind=JobKind.LABELS,
        created_at=datetime.now(tz=UTC),
        labels=labels,
        files=names,
        references=references,
    )
    inputs = {
        **{names[view]: file for view, file in maps.items()},
        **{references[surface]: file for surface, file in upload.references.items()},
    }
    job = submit(access.store, access.records, access.queue, request, inputs, owner)
    announce(job, response, access.settings)
    return answer(job, response, 202)
