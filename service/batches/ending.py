"""The end of a whole batch: every job cancelled, or everything erased."""

from collections.abc import Callable

from jobs import ending
from schemas.batch import BatchRecord
from service.access import JobAccess, no_such_batch
from service.batches.joining import member_ids
from service.batches.taking_in import take_in
from service.batches.unfinished import tail_of
from service.batches.view import known_jobs


def cancel_batch(access: JobAccess, record: BatchRecord) -> BatchRecord:
    """Ask every job of the batch to stop, and return the record as it is then. Idempotent.

    What was left half taken in is taken in first, so that nobody accepts it afterwards.
    """
    if record.pending:
        with access.batches.turn(tail_of(record)) as turn:
            found = access.batches.read(record.batch_id)
            if found is None:
                raise no_such_batch()
            record = take_in(access, found, turn)
    for job_id in known_jobs(access, member_ids(access, record)):
        ending.cancel(access.store.folder(job_id), access.records)
    return record


def erase_batch(access: JobAccess, record: BatchRecord, begin: Callable[[list[str]], None]) -> None:
    """Erase every job of the batch, then its record. Idempotent.

    In this order, so that a crash in between may be repeated. `begin` is told the ids of the jobs
    before the first goes, those included that an erasure cut short has erased already.
    """
    if record.pending:
        with access.batches.turn(tail_of(record)):
            record = record.after({}, [])
            access.batches.write(record)
    job_ids = [
        job_id
        for job_id in member_ids(access, record)
        if access.store.folder(job_id).exists()
        or access.records.get(job_id) is not None
        or access.erased.owner_of(job_id) is not None
    ]
    begin(job_ids)
    for job_id in job_ids:
        access.erased.remember(job_id, record.owner)
        ending.erase(access.store.folder(job_id), access.records)
    access.erased.remember(record.batch_id, record.owner)
    access.batches.erase(record.batch_id)
