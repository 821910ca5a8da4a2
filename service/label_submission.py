"""A label-map submission, received and judged: what submitting and validating have in common."""

from collections.abc import AsyncIterator
from dataclasses import dataclass
from typing import Annotated, Any, BinaryIO

from fastapi import Depends, Request

from intake.json_body import parse_json
from intake.label_maps import CheckedMap, check_label_maps
from intake.limits import Limits
from intake.references import judge_references
from schemas.labels import LabelRequest
from schemas.vocabulary import View
from service.access import Access
from service.form_description import form_content
from service.form_upload import FORM, FormUpload, received_form
from service.media_type import require_media_type

_VIEWS = (View.SAX, View.LAX_2CH, View.LAX_3CH, View.LAX_4CH)
_MAX_JSON_BYTES = 1 << 20

LABEL_BODY: dict[str, Any] = {
    "requestBody": {
        "required": True,
        "content": {
            FORM: form_content(
                "LabelRequest", {view.value: f"NIfTI label map of {view}." for view in _VIEWS}
            )
        },
    }
}


async def _received(request: Request, access: Access) -> AsyncIterator[FormUpload]:
    require_media_type(request, FORM)
    async with received_form(
        request, _VIEWS, access.settings.limits(), max_json_bytes=_MAX_JSON_BYTES
    ) as upload:
        yield upload


LabelUpload = Annotated[FormUpload, Depends(_received, scope="function")]


@dataclass(frozen=True)
class JudgedLabels:
    """A submission that the door takes; its voxels are still unread.

    references: what each reference mesh is called in the job's inputs, by its surface.
    """

    request: LabelRequest
    maps: dict[View, BinaryIO]
    checked: dict[View, CheckedMap]
    references: dict[str, str]

    @property
    def frames(self) -> int:
        """How many frames every view has."""
        return next(iter(self.checked.values())).header.frames


def judge_labels(upload: FormUpload, limits: Limits) -> JudgedLabels:
    """Everything that decides whether the submission is accepted. Raises InputError."""
    request = parse_json(upload.request, LabelRequest, limits)
    maps = {View(name): file for name, file in upload.files.items()}
    checked = check_label_maps(maps, request, limits)
    return JudgedLabels(request, maps, checked, judge_references(upload.references, limits))
