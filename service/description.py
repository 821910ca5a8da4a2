"""The API description: generated, with the models of bodies that FastAPI does not parse itself."""

from typing import Any

from fastapi import FastAPI
from fastapi.openapi.utils import get_openapi
from pydantic.json_schema import models_json_schema

from schemas.batch import BatchRequest
from schemas.labels import LabelRequest
from schemas.messages import ContourRequest
from schemas.problem import Problem
from schemas.restart import RestartRequest
from schemas.webhook import WebhookMessage, WebhookRequest
from service.links_description import add_links
from service.security_description import add_security

_DESCRIPTION = """\
Sparse planar segmentations of the heart in, 3D surfaces out.

Submit a contour study or label maps, poll the job, download meshes and a report. Submissions answer
202 with the job's address. Every error is an RFC 9457 problem document (application/problem+json):
`type` is stable, `detail` names the remedy, `pointer` is the JSON pointer (or the form part, or the
parameter) at fault, and `fault` says whose it is to mend. Lengths are mm unless a study says
otherwise; meshes come back in mm, in the study's own axes.
"""

_SUPERFLUOUS = ("HTTPValidationError", "ValidationError")


class DescribedApi(FastAPI):
    """A FastAPI application that describes itself in full."""

    def openapi(self) -> dict[str, Any]:
        if self.openapi_schema is None:
            self.openapi_schema = _description(self)
        return self.openapi_schema


def _description(app: FastAPI) -> dict[str, Any]:
    found = get_openapi(
        title="neuralmri",
        version="1",
        description=_DESCRIPTION,
        routes=app.routes,
        license_info={"name": "Apache-2.0", "identifier": "Apache-2.0"},
        servers=[{"url": "/"}],
        tags=[
            {"name": "submit", "description": "Send a study."},
            {"name": "jobs", "description": "Follow, cancel, restart and erase jobs."},
            {"name": "batches", "description": "Many jobs under one parent."},
            {"name": "results", "description": "Meshes and measures of a job that succeeded."},
            {"name": "webhooks", "description": "Be told when jobs end."},
            {"name": "operation", "description": "For those who run the service."},
        ],
    )
    _, bodies = models_json_schema(
        [
            (model, "validation")
            for model in (
                BatchRequest,
                ContourRequest,
                LabelRequest,
                RestartRequest,
                Problem,
                WebhookMessage,
                WebhookRequest,
            )
        ],
        ref_template="#/components/schemas/{model}",
    )
    schemas = found.setdefault("components", {}).setdefault("schemas", {})
    for name in _SUPERFLUOUS:
        schemas.pop(name, None)
    schemas.update(bodies["$defs"])
    found["components"]["schemas"] = dict(sorted(schemas.items()))
    add_security(found)
    add_links(found)
    return found
