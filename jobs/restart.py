"""A new job from what another one was given."""

from collections.abc import Mapping
from datetime import UTC, datetime

from jobs.folder import JobFolder
from jobs.stored_input import StoredInput, StoredObject
from schemas.messages import JobRequest
from schemas.options import Options


def options_of(request: JobRequest) -> Options:
    """The options that a job was given, whatever its kind."""
    given = request.contours or request.labels
    if given is None:
        raise ValueError(f"job {request.job_id} has neither contours nor labels")
    return given.options


def again(request: JobRequest, job_id: str, options: Options) -> JobRequest:
    """The request of a new job: the same inputs, other options."""
    contours, labels = request.contours, request.labels
    return request.model_copy(
        update={
            "job_id": job_id,
            "created_at": datetime.now(tz=UTC),
            "restarted_from": request.job_id,
            # The key of the first job stays its own: one key makes one job.
            "idempotency": None,
            "batch_id": None,
            "name": None,
            "contours": contours and contours.model_copy(update={"options": options}),
            "labels": labels and labels.model_copy(update={"options": options}),
        }
    )


def stored_inputs(
    folder: JobFolder, request: JobRequest
) -> Mapping[str, StoredInput | StoredObject]:
    """The input files of a job by their names. Raises JobGone."""
    names = [*request.files.values(), *request.references.values()]
    return {name: folder.stored_input(name) for name in names}
