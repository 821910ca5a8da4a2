"""Batches: look at one or all, cancel, erase."""

from typing import Annotated

from fastapi import APIRouter, Query, Request, Response

from jobs.batch_store import BATCH_ID_PATTERN, is_batch_id
from schemas.batch import Batch, BatchPage, BatchRecord, MemberState
from service.access import Access
from service.batches.ending import cancel_batch, erase_batch
from service.batches.view import batch_members, batch_of, summary
from service.documented import problems

router = APIRouter(tags=["batches"])

_MEMBER_KEY = r"^([0-9]{6}|[0-9a-f]{32})$"


@router.get("/v1/batches", responses=problems(422, 503))
def list_batches(
    access: Access,
    limit: Annotated[int, Query(ge=1, le=100)] = 20,
    cursor: Annotated[
        str | None,
        Query(pattern=BATCH_ID_PATTERN, description="`next_cursor` of the page before."),
    ] = None,
) -> BatchPage:
    """Your batches, newest first, without their studies; with the scope `admin`, everybody's."""
    found: list[BatchRecord] = []
    for batch_id in reversed(access.batches.ids()):
        if cursor is not None and batch_id >= cursor:
            continue
        owner = access.batches.owner(batch_id)
        if owner is None or not access.caller.sees(owner):
            continue
        if record := access.batches.read(batch_id):
            found.append(record)
        if len(found) > limit:
            break
    return BatchPage(
        batches=[summary(record, *batch_members(access, record)) for record in found[:limit]],
        next_cursor=found[limit - 1].batch_id if len(found) > limit else None,
    )


@router.get("/v1/batches/{batch_id}", responses=problems(404, 422, 503))
def get_batch(
    batch_id: str,
    access: Access,
    response: Response,
    limit: Annotated[int, Query(ge=1, le=1000, description="Studies of one page.")] = 100,
    cursor: Annotated[
        str | None, Query(pattern=_MEMBER_KEY, description="`next_cursor` of the page before.")
    ] = None,
) -> Batch:
    """How a batch stands, and each of its studies. Poll until `ended`."""
    batch = batch_of(access, access.batch(batch_id), limit, cursor)
    if not batch.ended:
        response.headers["Retry-After"] = str(access.settings.poll_after_s)
    return batch


@router.post(
    "/v1/batches/{batch_id}/cancel",
    status_code=200,
    responses={
        202: {"model": Batch, "description": "Workers were told; poll until they have stopped."},
        200: {"description": "Every job is at its end: cancelled now, or ended before."},
        **problems(404, 409, 503),
    },
)
def cancel_batch_jobs(batch_id: str, access: Access, request: Request, response: Response) -> Batch:
    """Stop the work on every job of the batch, keep the jobs. Doing it again changes nothing."""
    batch = batch_of(access, cancel_batch(access, access.batch(batch_id)))
    request.state.jobs_of_batch = [
        member.job_id
        for member in batch.studies
        if member.state in (MemberState.CANCELLED, MemberState.CANCELLING)
    ]
    if not batch.ended:
        response.status_code = 202
        response.headers["Retry-After"] = str(access.settings.poll_after_s)
    return batch


@router.delete(
    "/v1/batches/{batch_id}",
    status_code=204,
    response_class=Response,
    responses=problems(404, 409, 503),
)
def erase_batch_jobs(batch_id: str, access: Access, request: Request) -> None:
    """Erase the batch and every job of it: inputs, results and records.

    Erasing an erased batch is not an error. Unlike erasing a job it needs Redis, which knows what
    joined the batch.
    """
    is_gone = is_batch_id(batch_id) and access.batches.read(batch_id) is None
    if is_gone and access.has_erased(batch_id):
        return

    def begin(job_ids: list[str]) -> None:
        request.state.jobs_of_batch = job_ids

    erase_batch(access, access.batch(batch_id), begin)
