"""Accepting the studies of a batch, one after another: by whoever sent it, sends it again, or finds
it half done after a crash.
"""

import errno

from redis.exceptions import RedisError

from jobs import log_context
from jobs.admission import Verdict
from jobs.store_errors import StoreUnavailable
from schemas.batch import BatchItem, BatchRecord
from schemas.messages import JobRequest
from schemas.problem import InternalError, ProblemType, ServiceError
from service.acceptance import submitted
from service.access import JobAccess
from service.batches.book import Turn, still_taken_in
from service.refusals import no_room

_FULL = (errno.ENOSPC, errno.EDQUOT)
_AWAY = (ProblemType.UNAVAILABLE, ProblemType.STORE_UNAVAILABLE)
"""Nothing is said of a study by these: it stays pending."""


def take_in(
    access: JobAccess, record: BatchRecord, turn: Turn, *, until_room: bool = False
) -> BatchRecord:
    """Accept or refuse every pending study; the record says so when this returns.

    Done again after a crash it goes on where the first was: a job that has a folder was accepted,
    and so was one that its owner has erased since. With `until_room` what finds no room now stays
    pending.

    Raises InternalError (unavailable, 503) where Redis or the store fails on the way: the record is
    as it was, unless nothing was accepted and its sender is here to send it again; then the batch
    is erased.
    Raises InputError (409) where the turn is lost to another.
    """
    if not record.pending:
        return record
    refused: dict[str, BatchItem] = {}
    waiting: list[JobRequest] = []
    for request in record.pending:
        try:
            if not turn.hold():
                raise still_taken_in()
            if not _was_accepted(access, request):
                _accept(access, request)
        except RedisError as error:
            raise _interrupted(access, record, turn, may_erase=not until_room) from error
        except ServiceError as error:
            if error.type is ProblemType.IDEMPOTENCY_KEY_PENDING:
                raise
            if error.type in _AWAY:
                raise _interrupted(access, record, turn, may_erase=not until_room) from error
            if until_room:
                waiting.append(request)
            else:
                item = next(i for i in record.items if i.job_id == request.job_id)
                refused[request.job_id] = refusal(error, access, record.items.index(item), item)
    log_context.current().job_id = None
    after = record.after(refused, waiting)
    if after != record:
        access.batches.write(after)
    return after


def refusal(error: ServiceError, access: JobAccess, place: int, item: BatchItem) -> BatchItem:
    """What the record says of a study that was refused. Pointers lead into the batch's body."""
    again_s = error.retry_after_s
    if again_s is None and error.status in (503, 507):
        again_s = access.settings.retry_after_s
    problem = error.problem()
    here = f"/studies/{place}"
    return BatchItem(
        name=item.name,
        problem=problem.model_copy(
            update={
                "pointer": here + (problem.pointer or ""),
                "errors": [
                    part.model_copy(update={"pointer": here + part.pointer})
                    for part in problem.errors
                ],
            }
        ),
        retry_after_s=again_s,
    )


def _was_accepted(access: JobAccess, request: JobRequest) -> bool:
    erased = access.erased.owner_of(request.job_id) is not None
    return erased or access.store.folder(request.job_id).exists()


def _accept(access: JobAccess, request: JobRequest) -> None:
    answer = access.admission.ask(request, request.owner)
    if answer.verdict is not Verdict.ADMITTED:
        raise no_room(answer, access)
    try:
        submitted(access, request, {}, request.owner)
    except OSError as error:
        if error.errno not in _FULL:
            raise
        raise InternalError(
            ProblemType.STORAGE_FULL,
            "the store is full; this study was not accepted. Remedy: erase jobs that are no longer "
            "needed (DELETE), or try again later.",
            status=507,
        ) from error


def _may_hold_one(access: JobAccess, record: BatchRecord) -> bool:
    """Whether a job of the batch is there, as far as the store can be asked."""
    try:
        return any(access.store.folder(job_id).exists() for job_id in record.job_ids)
    except StoreUnavailable:
        return True


def _interrupted(
    access: JobAccess, record: BatchRecord, turn: Turn, *, may_erase: bool
) -> InternalError:
    """The answer where Redis or the store fails on the way."""
    if not (may_erase and turn.is_held) or _may_hold_one(access, record):
        return InternalError(
            ProblemType.UNAVAILABLE,
            f"the queue cannot be reached; batch {record.batch_id} is stored, and what of it was "
            "not accepted yet is once the queue is back. Remedy: look at it later, or send "
            "the request again under its Idempotency-Key.",
            status=503,
        )
    access.batches.erase(record.batch_id)
    return _unavailable()


def _unavailable() -> InternalError:
    return InternalError(
        ProblemType.UNAVAILABLE,
        "the queue cannot be reached; nothing was accepted, send the request again in a while",
        status=503,
    )
