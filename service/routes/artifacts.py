"""The results of a job that succeeded. They are read from its folder: Redis is not asked."""

import hashlib
from typing import Annotated, Any

from fastapi import APIRouter, Header, Response
from starlette.responses import FileResponse

from jobs.folder import JobFolder
from jobs.stored_file import StoredFile
from schemas.artifacts import MANIFEST_NAME, Manifest
from schemas.job import JobState
from schemas.media_types import ARTIFACT_MEDIA_TYPES
from schemas.problem import InputError, InternalError, ProblemType
from schemas.report import Report
from service.access import Access, JobAccess, no_such_job
from service.conditional import is_unmodified
from service.documented import problems
from service.problems import NotReadyError
from service.stored_file_response import StoredFileResponse

router = APIRouter(tags=["results"])

# A report has its own style, script and pictures inside, and links to the meshes beside it, which
# are downloads. Its script draws and reaches nothing else: no network, no cookies, no storage, no
# frames, no forms; the sandbox gives the page an origin that it shares with nothing, not with this
# API either.
_SANDBOX = (
    "sandbox allow-scripts allow-downloads; default-src 'none'; style-src 'unsafe-inline'; "
    "script-src 'unsafe-inline'; img-src data: blob:"
)

_FILE: dict[int | str, dict[str, Any]] = {
    200: {
        "description": "The whole file.",
        "headers": {
            "ETag": {"description": "The sha256, quoted.", "schema": {"type": "string"}},
            "Content-Disposition": {"schema": {"type": "string"}},
        },
        "content": {type_: {} for type_ in ARTIFACT_MEDIA_TYPES.values()},
    },
    206: {"description": "The bytes that Range asked for."},
    304: {"description": "If-None-Match names the file as it is."},
}

IfNoneMatch = Annotated[str | None, Header()]


@router.get("/v1/jobs/{job_id}/artifacts", responses=problems(404, 409))
def list_artifacts(job_id: str, access: Access) -> Manifest:
    """Every artifact with its bytes and sha256. Each is at `artifacts/{name}`."""
    return published(access, access.folder(job_id))


@router.get(
    "/v1/jobs/{job_id}/report",
    response_model=Report,
    responses=problems(404, 409),
)
def get_report(job_id: str, access: Access, if_none_match: IfNoneMatch = None) -> Response:
    """`report.json`: volumes, residuals, slice shifts, timings, provenance."""
    return _file(access, job_id, "report.json", if_none_match)


@router.head("/v1/jobs/{job_id}/artifacts/{name}", include_in_schema=False)
@router.get(
    "/v1/jobs/{job_id}/artifacts/{name}",
    response_class=FileResponse,
    responses={**_FILE, **problems(404, 409, 416)},
)
def get_artifact(
    job_id: str, name: str, access: Access, if_none_match: IfNoneMatch = None
) -> Response:
    """One file, whole or in ranges."""
    return _file(access, job_id, name, if_none_match)


def published(access: JobAccess, folder: JobFolder) -> Manifest:
    """The manifest of a job that succeeded. Raises NotReadyError, InternalError."""
    outcome = folder.outcome()
    if outcome is None:
        raise NotReadyError(
            "the job is not finished. Remedy: poll it and come back when it has succeeded.",
            access.settings.poll_after_s,
        )
    if outcome.state is not JobState.SUCCEEDED:
        raise NotReadyError(
            f"the job has {outcome.state} and will have no results. Remedy: see its `error`, and "
            "submit it anew.",
            None,
        )
    manifest = folder.manifest()
    if manifest is None:
        if not folder.exists():
            raise no_such_job()
        raise InternalError(ProblemType.INTERNAL, "the job's results are missing in the store.")
    return manifest


def _file(access: JobAccess, job_id: str, name: str, if_none_match: str | None) -> Response:
    folder = access.folder(job_id)
    file, media_type, sha256 = _found(folder, published(access, folder), name)
    headers = {
        "ETag": f'"{sha256}"',
        # It may be kept by the caller, who asks each time whether it is still there.
        "Cache-Control": "private, no-cache",
    }
    if is_unmodified(if_none_match, headers["ETag"]):
        return Response(status_code=304, headers=headers)
    shown = media_type.startswith(("text/html", "application/json"))
    if shown:
        headers["Content-Security-Policy"] = _SANDBOX
    return StoredFileResponse(
        file, filename=name, media_type=media_type, headers=headers, is_shown=shown
    )


def _found(folder: JobFolder, manifest: Manifest, name: str) -> tuple[StoredFile, str, str]:
    """An artifact, its media type and sha256. Raises JobGone or InputError (not found, 404)."""
    if name == MANIFEST_NAME:  # it cannot list itself
        file = folder.artifact(name)
        with file.open() as opened:
            return file, "application/json", hashlib.sha256(opened.read()).hexdigest()
    for artifact in manifest.artifacts:
        if artifact.name == name:
            return folder.artifact(name), artifact.media_type, artifact.sha256
    raise InputError(
        ProblemType.NOT_FOUND,
        "the job has no artifact of this name. Remedy: list them at its `artifacts`.",
        status=404,
    )
