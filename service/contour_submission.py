"""A contour submission, received and judged: what submitting and validating have in common."""

from collections.abc import AsyncIterator
from dataclasses import dataclass
from typing import Annotated, Any

from fastapi import Depends, Request

from intake.contour_request import read_contour_request
from intake.limits import Limits
from intake.references import check_reference_surfaces, judge_references
from schemas.messages import ContourRequest
from service.access import Access
from service.examples import CONTOUR_REQUEST
from service.form_description import form_content
from service.form_upload import FORM, FormUpload, received_form
from service.media_type import require_media_type

_JSON = "application/json"

CONTOUR_BODY: dict[str, Any] = {
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


async def _received(request: Request, access: Access) -> AsyncIterator[FormUpload]:
    """The body: JSON alone, or a form of the same JSON and reference meshes."""
    if require_media_type(request, _JSON, FORM) == _JSON:
        yield FormUpload(await request.body())
        return
    limits = access.settings.limits()
    async with received_form(
        request, (), limits, max_json_bytes=limits.max_request_bytes
    ) as upload:
        yield upload


ContourUpload = Annotated[FormUpload, Depends(_received, scope="function")]


@dataclass(frozen=True)
class JudgedContours:
    """A submission that the door takes.

    references: what each reference mesh is called in the job's inputs, by its surface.
    """

    request: ContourRequest
    warnings: list[str]
    references: dict[str, str]


def judge_contours(upload: FormUpload, limits: Limits) -> JudgedContours:
    """Everything that decides whether the submission is accepted. Raises InputError."""
    request, warnings = read_contour_request(upload.request, limits)
    check_reference_surfaces(request.study, request.options, upload.references)
    return JudgedContours(
        request, [*request.warnings, *warnings], judge_references(upload.references, limits)
    )
