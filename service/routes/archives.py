"""Results in one ZIP archive: of a job, or of every job of a batch. Streamed from the folders."""

from collections.abc import Iterator
from datetime import UTC, datetime
from typing import Annotated, Any

from fastapi import APIRouter, Query
from fastapi.responses import StreamingResponse
from pydantic import StringConstraints

from schemas.artifacts import Manifest
from schemas.batch import Batch, MemberState
from service.access import Access
from service.batches.view import batch_of
from service.documented import problems
from service.job_archive import PATTERN, archive_folders, archived, nothing_fits, wanted
from service.problems import NotReadyError
from service.routes.artifacts import published
from service.zip_stream import ZipMember, zip_stream

router = APIRouter(tags=["results"])

_ZIP = "application/zip"
_ANSWER: dict[int | str, dict[str, Any]] = {
    200: {
        "description": "The archive. It has no length beforehand; one that breaks off has no "
        "directory, and is not taken for whole.",
        "content": {_ZIP: {"schema": {"type": "string", "contentMediaType": _ZIP}}},
    }
}

Patterns = Annotated[
    list[Annotated[str, StringConstraints(pattern=PATTERN)]] | None,
    Query(
        alias="artifact",
        max_length=20,
        description="Only artifacts of such a name, with `*` and `?`; give it once a pattern.",
        examples=[["*.stl"]],
    ),
]


class ArchiveResponse(StreamingResponse):
    """An archive as a download."""

    media_type = _ZIP

    @classmethod
    def of(cls, members: Iterator[ZipMember], name: str) -> "ArchiveResponse":
        headers = {
            "Content-Disposition": f'attachment; filename="{name}.zip"',
            "X-Accel-Buffering": "no",
        }
        return cls(zip_stream(members), headers=headers)


@router.get(
    "/v1/jobs/{job_id}/artifacts.zip",
    response_class=ArchiveResponse,
    responses={**_ANSWER, **problems(404, 409, 422)},
)
def get_job_archive(job_id: str, access: Access, artifact: Patterns = None) -> ArchiveResponse:
    """Every artifact of a job that succeeded, in one archive. Redis is not asked."""
    folder = access.folder(job_id)
    manifest = published(access, folder)
    names = wanted(manifest, artifact or [])
    if not names:
        raise nothing_fits()
    return ArchiveResponse.of(archived(folder, manifest, "", names), job_id)


@router.get(
    "/v1/batches/{batch_id}/artifacts.zip",
    response_class=ArchiveResponse,
    responses={**_ANSWER, **problems(404, 409, 422, 503)},
)
def get_batch_archive(batch_id: str, access: Access, artifact: Patterns = None) -> ArchiveResponse:
    """The results of every job of a batch that succeeded, in a folder each, and `batch.json`.

    A folder is called as the study was named; by the job's id without a name, and by both where an
    earlier study has the name. Before every job has ended it is 409.
    """
    batch = batch_of(access, access.batch(batch_id))
    if not batch.ended:
        raise NotReadyError(
            "the batch is not finished. Remedy: come back when every job of it has ended.",
            access.settings.poll_after_s,
        )
    found: list[tuple[str, Manifest, list[str]]] = []
    for member in batch.studies:
        if member.job_id is not None and member.state is MemberState.SUCCEEDED:
            manifest = published(access, access.folder(member.job_id))
            if names := wanted(manifest, artifact or []):
                found.append((member.job_id, manifest, names))
    if not found and batch.counts[MemberState.SUCCEEDED]:
        raise nothing_fits()
    if not found:
        raise NotReadyError(
            "no job of the batch has succeeded, so there are no results. Remedy: see each study's "
            "`error`.",
            None,
        )
    folders = archive_folders((m.job_id, m.name) for m in batch.studies if m.job_id)

    def members() -> Iterator[ZipMember]:
        yield _overview(batch)
        for job_id, manifest, names in found:
            folder = access.store.folder(job_id)
            yield from archived(folder, manifest, f"{folders[job_id]}/", names)

    return ArchiveResponse.of(members(), batch_id)


def _overview(batch: Batch) -> ZipMember:
    """The batch itself: which folder is which job, and why others have none."""
    text = batch.model_dump_json(indent=1).encode()
    return ZipMember("batch.json", len(text), datetime.now(tz=UTC), [text])
