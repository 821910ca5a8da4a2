"""Making Redis agree with the folders: after a crash, a lost queue, a lost Redis."""

from dataclasses import dataclass
from typing import Literal

from jobs.ending import cancel, settle
from jobs.errors import JobGone
from jobs.folder import JobFolder
from jobs.queue import JobQueue
from jobs.records import JobRecords
from jobs.store import JobStore
from schemas.job import JobState
from schemas.messages import ReconstructMessage


@dataclass(frozen=True)
class Reconciled:
    """What one round mended: ids of jobs by what was done about them."""

    restored: tuple[str, ...] = ()
    enqueued: tuple[str, ...] = ()
    ended: tuple[str, ...] = ()
    forgotten: tuple[str, ...] = ()

    @property
    def is_something(self) -> bool:
        return bool(self.restored or self.enqueued or self.ended or self.forgotten)


def reconcile(
    store: JobStore, records: JobRecords, queue: JobQueue, lost_after_s: float
) -> Reconciled:
    """Bring every job that has a folder to where a worker or its caller will find it.

    - A folder that Redis does not know is restored, and enqueued if it has no outcome.
    - A job whose folder has an outcome is terminal in Redis; a job that is terminal in Redis has an
      outcome in its folder; a cancelling job without a worker is cancelled.
    - A job that had neither a live lease for `lost_after_s` nor a message waiting is enqueued.
    - A record without a folder is an erased job, and is forgotten.

    Any number of processes may do this at any time. Raises RedisError, or InternalError where the
    queue takes no message; the next round goes on from there.
    """
    store.sweep()
    begun = records.wholeness.begin_round()
    waiting = queue.waiting()
    # Listed before the folders: a folder is made before its record.
    known = records.ids()
    folders = store.ids()
    done: dict[str, list[str]] = {"restored": [], "enqueued": [], "ended": []}
    for job_id in folders:
        folder = store.folder(job_id)
        try:
            mended = _mend(folder, records)
        except JobGone:
            continue  # erased under our hands
        if mended:
            done[mended].append(job_id)
        if job_id in waiting:
            continue
        if mended == "restored" or records.reclaimed(job_id, lost_after_s):
            job = records.get(job_id)
            if job is not None:
                queue.enqueue(ReconstructMessage.of_job(job))
                done["enqueued"].append(job_id)
    # One listing, not a question a job: the store may be far away.
    forgotten = {*known, *folders}.difference(store.ids())
    for job_id in forgotten:
        records.forget(job_id)
    records.wholeness.end_round(begun)
    return Reconciled(
        **{what: tuple(ids) for what, ids in done.items()}, forgotten=tuple(sorted(forgotten))
    )


def _mend(folder: JobFolder, records: JobRecords) -> Literal["restored", "ended"] | None:
    """Make record and folder of one job agree, and say what it took. Raises JobGone."""
    job = records.get(folder.job_id)
    outcome = folder.outcome()
    if job is None:
        was_unknown = records.restore(folder.request(), outcome)
        if outcome is not None:
            return "ended"
        return "restored" if was_unknown else None
    if job.state.is_terminal:
        if outcome is not None and outcome.state is job.state:
            return None
        settle(folder, records, job)
        return "ended"
    if outcome is not None:
        records.restore(folder.request(), outcome)
        return "ended"
    if job.state is JobState.CANCELLING:
        return "ended" if cancel(folder, records) is JobState.CANCELLED else None
    return None
