"""What a job was asked, given back, so that it can be done again."""

from typing import Any

from fastapi import APIRouter, Response

from schemas.problem import InputError, ProblemType
from service.access import Access
from service.documented import problems

router = APIRouter(tags=["jobs"])

_BODY: dict[int | str, dict[str, Any]] = {
    200: {
        "description": "As `POST /v1/jobs/contours` takes it, with every option spelled out.",
        "content": {
            "application/json": {"schema": {"$ref": "#/components/schemas/ContourRequest"}}
        },
    }
}


@router.get(
    "/v1/jobs/{job_id}/request",
    response_class=Response,
    responses={**_BODY, **problems(404, 409)},
)
def get_request(job_id: str, access: Access) -> Response:
    """The study and options of a contour job, whatever its state. Redis is not asked.

    Files that were sent, label maps and references, are not given back.
    """
    contours = access.folder(job_id).request().contours
    if contours is None:
        raise InputError(
            ProblemType.INPUTS_NOT_SERVED,
            "the job was made from label maps, which are files that are not given back. Remedy: "
            "name the files you sent, as in `neuralmri rerun JOB --label-scheme ... --sax FILE`.",
            status=409,
        )
    return Response(contours.model_dump_json(), media_type="application/json")
