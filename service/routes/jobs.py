"""The jobs: look at one or all, cancel, erase."""

from typing import Annotated, Any

from fastapi import APIRouter, Query, Response

from jobs import ending
from jobs.batch_store import BATCH_ID_PATTERN
from jobs.store import JOB_ID_PATTERN
from schemas.job import Job, JobPage, JobState
from service.access import Access
from service.documented import problems
from service.held_answer import PREFERENCE_APPLIED, Answer

router = APIRouter(tags=["jobs"])

_RETRY_AFTER: dict[str, Any] = {
    "Retry-After": {
        "description": "Seconds until the next look, while the job is not at its end.",
        "schema": {"type": "integer", "minimum": 1},
    }
}


@router.get("/v1/jobs", responses=problems(404, 422, 503))
def list_jobs(
    access: Access,
    state: Annotated[JobState | None, Query(description="Only jobs in this state.")] = None,
    limit: Annotated[int, Query(ge=1, le=200)] = 50,
    cursor: Annotated[
        str | None,
        Query(pattern=JOB_ID_PATTERN, description="`next_cursor` of the page before."),
    ] = None,
    batch: Annotated[
        str | None, Query(pattern=BATCH_ID_PATTERN, description="Only jobs of this batch.")
    ] = None,
) -> JobPage:
    """Your jobs, newest first; with the scope `admin`, everybody's."""
    if batch is not None:
        access.batch(batch)
    page = access.records.page(access.caller.listed_owner, state, limit, cursor, batch)
    return page.model_copy(update={"jobs": access.line.placed(page.jobs)})


@router.get(
    "/v1/jobs/{job_id}",
    response_model=Job,
    responses={200: {"headers": _RETRY_AFTER | PREFERENCE_APPLIED}, **problems(404, 503)},
)
def get_job(job_id: str, access: Access, response: Response, answer: Answer) -> Job | Response:
    """How a job stands. Poll until `state` is cancelled, succeeded or failed."""
    job = access.job(job_id)
    if not job.state.is_terminal:
        response.headers["Retry-After"] = str(access.settings.poll_after_s)
    return answer(job, response, 200)


@router.post(
    "/v1/jobs/{job_id}/cancel",
    status_code=200,
    responses={
        202: {"model": Job, "description": "The worker was told; poll until it has stopped."},
        200: {"description": "The job is at its end: cancelled now, or ended before."},
        **problems(404, 503),
    },
)
def cancel_job(
    job_id: str,
    access: Access,
    response: Response,
    keep_frames: Annotated[
        bool,
        Query(
            description="Measure and write the frames that are finished: the job then ends as "
            "succeeded with these, and names the others in `failed_frames`. Without a finished "
            "frame it is cancelled as ever."
        ),
    ] = False,
) -> Job:
    """Stop the work, keep the job. Doing it again, or too late, changes nothing."""
    access.job(job_id)
    folder = access.store.folder(job_id)
    state = ending.cancel(folder, access.records, keeps_frames=keep_frames)
    if state is JobState.CANCELLING:
        response.status_code = 202
        response.headers["Retry-After"] = str(access.settings.poll_after_s)
    return access.job(job_id)


@router.delete(
    "/v1/jobs/{job_id}",
    status_code=204,
    response_class=Response,
    responses=problems(404),
)
def erase_job(job_id: str, access: Access) -> None:
    """Erase the job: inputs, results and record; a running one is stopped first.

    Erasing an erased job is not an error. Redis need not answer.
    """
    folder = access.erasable(job_id)
    owner = access.owners.of(folder)
    if owner is not None:
        access.erased.remember(job_id, owner)  # first: a crash in between may be repeated
    ending.erase(folder, access.records)
