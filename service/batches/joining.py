"""Which jobs are in a batch: those planned with it, and those that joined by `?batch=`."""

from jobs.reconcile import reconcile
from schemas.batch import BatchRecord
from schemas.problem import InputError, ProblemType
from service.access import JobAccess, no_such_batch


def member_ids(access: JobAccess, record: BatchRecord) -> list[str]:
    """Jobs of the batch: planned ones in their order, erased ones included, then who joined.

    Raises RedisError. Where Redis has lost something it is rebuilt first, so that none is missed.
    """
    if not access.records.wholeness.is_certain():
        reconcile(access.store, access.records, access.queue, access.settings.lost_after_s)
    planned = record.job_ids
    return list(dict.fromkeys([*planned, *access.records.of_batch(record.batch_id)]))


def require_room(access: JobAccess, batch_id: str, owner: str) -> None:
    """Raise InputError where the batch is not the owner's (404), or is full (413).

    Of submissions that arrive at once a few more may get in than there is room for.
    """
    record = access.batches.read(batch_id)
    if record is None or record.owner != owner:
        raise no_such_batch()
    most = access.settings.max_batch_studies
    refused = len(record.items) - len(record.job_ids)
    if refused + len(member_ids(access, record)) >= most:
        raise too_many(most, "/query/batch")


def too_many(most: int, pointer: str) -> InputError:
    """The refusal of what would make a batch larger than it may be."""
    return InputError(
        ProblemType.TOO_LARGE,
        f"a batch has at most {most} studies. Remedy: send the others in another batch.",
        pointer=pointer,
        status=413,
    )
