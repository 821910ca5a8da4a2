"""A submission of contour files of other programs: read into a study at the door, and judged."""

from collections.abc import AsyncIterator
from typing import Annotated, Any

from fastapi import Depends, Request

from intake.formats.registry import import_study
from intake.json_body import parse_json
from intake.limits import Limits
from intake.references import check_reference_surfaces, judge_references
from intake.study import admit
from schemas.contour_files import ContourFilesRequest
from schemas.messages import ContourRequest
from service.access import Access
from service.contour_submission import JudgedContours
from service.form_description import form_content
from service.form_upload import FILE_PART, FORM, FormUpload, received_form
from service.media_type import require_media_type

_MAX_JSON_BYTES = 1 << 20

_MOST_FILES_A_FRAME = 8
"""Files are one a frame, or one a frame and structure, and one for them all."""

FILES_BODY: dict[str, Any] = {
    "requestBody": {
        "required": True,
        "content": {
            FORM: form_content(
                "ContourFilesRequest",
                {},
                many="Contour files of one subject in one format, each with a file name.",
            )
        },
    }
}


async def _received(request: Request, access: Access) -> AsyncIterator[FormUpload]:
    require_media_type(request, FORM)
    limits = access.settings.limits()
    async with received_form(
        request,
        (),
        limits,
        max_json_bytes=_MAX_JSON_BYTES,
        set_of=_MOST_FILES_A_FRAME * limits.max_frames,
    ) as upload:
        yield upload


FilesUpload = Annotated[FormUpload, Depends(_received, scope="function")]


def judge_files(upload: FormUpload, limits: Limits) -> JudgedContours:
    """The contour job that the files ask for. Raises InputError.

    The warnings of reading go into its request, and so into the report.
    """
    asked = parse_json(upload.request, ContourFilesRequest, limits)
    files = {name.removeprefix(f"{FILE_PART} "): file.read() for name, file in upload.files.items()}
    imported = import_study(files, asked, limits)
    request = ContourRequest(
        study=imported.study, options=asked.options, warnings=list(imported.warnings)
    )
    warnings = admit(request.study, request.options, limits)
    check_reference_surfaces(request.study, request.options, upload.references)
    return JudgedContours(
        request,
        [*request.warnings, *warnings],
        judge_references(upload.references, limits),
    )
