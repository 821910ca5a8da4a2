"""GET /v1/options: what may be chosen, for whoever builds a form or checks before sending."""

import hashlib
from dataclasses import asdict
from functools import cache
from typing import Annotated, Any

from fastapi import APIRouter, Header, Response

from intake.limits import Limits
from schemas.choices import Choices
from schemas.label_schemes import published_labels
from schemas.labels import LabelScheme
from schemas.options import PRESETS, Options, Preset
from schemas.vocabulary import Axes, MeshFormat, Structure, Units, View
from service.access import Access
from service.conditional import is_unmodified
from service.documented import problems

router = APIRouter(tags=["submit"])

_KEPT_FOR = "public, max-age=300"

_ANSWERS: dict[int | str, dict[str, Any]] = {
    200: {
        "description": "The same until the service is restarted.",
        "headers": {
            "ETag": {"description": "Of this very answer.", "schema": {"type": "string"}},
            "Cache-Control": {"schema": {"type": "string"}},
        },
    },
    304: {"description": "If-None-Match names the answer as it is."},
}


@router.get("/v1/options", response_model=Choices, responses={**_ANSWERS, **problems()})
def get_options(access: Access, if_none_match: Annotated[str | None, Header()] = None) -> Response:
    """The options with their bounds, presets, label schemes, limits and formats."""
    body, etag = _choices(access.settings.limits())
    headers = {"ETag": etag, "Cache-Control": _KEPT_FOR}
    if is_unmodified(if_none_match, etag):
        return Response(status_code=304, headers=headers)
    return Response(body, headers=headers, media_type="application/json")


@cache
def _choices(limits: Limits) -> tuple[bytes, str]:
    """The answer and its quoted ETag."""
    choices = Choices(
        options=Options.model_json_schema(),
        defaults=Options().model_dump(mode="json"),
        presets={Preset(name): values for name, values in PRESETS.items()},
        label_schemes={
            scheme: {
                view: published_labels(scheme, view) for view in View if view is not View.OTHER
            }
            for scheme in LabelScheme
        },
        limits=asdict(limits),
        formats=list(MeshFormat),
        structures=list(Structure),
        views=list(View),
        units=list(Units),
        axes=list(Axes),
    )
    body = choices.model_dump_json().encode()
    return body, f'"{hashlib.sha256(body).hexdigest()}"'
