"""Making Redis agree with the folders: after a crash, a lost queue, a lost Redis."""

import logging
from dataclasses import dataclass
from typing import Literal

from jobs.ending import cancel, settle
from jobs.errors import JobGone
from jobs.folder import JobFolder
from jobs.queue import JobQueue
from jobs.records import JobRecords
from jobs.settled import Settled
from jobs.store import JobStore
from jobs.store_errors import StoreUnavailable
from schemas.job import JobState
from schemas.messages import JobRequest, ReconstructMessage

_LOGGER = logging.getLogger(__name__)


@dataclass(frozen=True)
class Reconciled:
    """What one round mended: ids of jobs by what was done about them.

    quarantined: names of what was no job, and was moved out of the way.
    """

    restored: tuple[str, ...] = ()
    enqueued: tuple[str, ...] = ()
    ended: tuple[str, ...] = ()
    forgotten: tuple[str, ...] = ()
    quarantined: tuple[str, ...] = ()

    @property
    def is_something(self) -> bool:
        return self != Reconciled()


def reconcile(
    store: JobStore,
    records: JobRecords,
    queue: JobQueue,
    lost_after_s: float,
    settled: Settled | None = None,
) -> Reconciled:
    """Bring every job that has a folder to where a worker or its caller will find it.

    - A folder that Redis does not know is restored, and enqueued if it has no outcome.
    - A job whose folder has an outcome is terminal in Redis; a job that is terminal in Redis has an
      outcome in its folder; a cancelling job without a worker is cancelled.
    - A job that had neither a live lease for `lost_after_s` nor a message waiting is enqueued.
    - A record without a folder is an erased job, and is forgotten.
    - A folder that is no job is put into quarantine, and keeps no other job waiting.

    `settled` is what earlier rounds of this process found to need nothing more.

    Any number of processes may do this at any time. Raises RedisError, or InternalError where the
    queue takes no message; the next round goes on from there.
    """
    store.sweep()
    begun = records.wholeness.begin_round()
    waiting = queue.waiting()
    # Listed before the folders: a folder is made before its record.
    known = records.ids()
    folders = store.ids()
    settled = settled or Settled()
    left = settled.left(folders, records)
    done: dict[str, list[str]] = {"restored": [], "enqueued": [], "ended": []}
    suspects: set[str] = set()
    unread: set[str] = set()
    for job_id in left:
        folder = store.folder(job_id)
        try:
            mended = _mend(folder, records)
        except JobGone:
            continue  # erased under our hands, or it has no request
        except ValueError:
            suspects.add(job_id)  # what is wrong with it is said where it is judged
            continue
        except OSError as error:
            _LOGGER.warning("job %s was not mended: %s", job_id, error)
            unread.add(job_id)
            continue
        is_tidy = mended in ("settled", "ended") and _is_tidied(folder)
        if mended == "settled":
            if is_tidy:
                settled.note(job_id)
            continue
        if mended:
            done[mended].append(job_id)
        if job_id in waiting:
            continue
        if mended == "restored" or records.reclaimed(job_id, lost_after_s):
            job = records.get(job_id)
            if job is not None:
                queue.enqueue(ReconstructMessage.of_job(job))
                done["enqueued"].append(job_id)
    # What was settled was not touched: one that is erased by now is not listed next time.
    touched = {*left, *known} - (set(folders) - set(left))
    gone = store.gone(touched - unread)
    quarantined = store.set_aside(suspects | unread | gone.intersection(folders))
    forgotten = gone | set(known).intersection(quarantined)
    for job_id in forgotten:
        records.forget(job_id)
    if unread.issubset(quarantined):
        # Else an idempotency key may be known to a folder alone.
        records.wholeness.end_round(begun)
    return Reconciled(
        **{what: tuple(ids) for what, ids in done.items()},
        forgotten=tuple(sorted(forgotten)),
        quarantined=quarantined,
    )


def _mend(folder: JobFolder, records: JobRecords) -> Literal["restored", "ended", "settled"] | None:
    """Make record and folder of one job agree, and say what it took.

    Raises JobGone, ValueError where the folder is damaged, OSError.
    """
    job = records.get(folder.job_id)
    outcome = folder.outcome()
    if job is None:
        was_unknown = records.restore(_request(folder), outcome)
        if outcome is not None:
            return "ended"
        return "restored" if was_unknown else None
    if job.state.is_terminal:
        if outcome is not None and outcome.state is job.state:
            return "settled"
        settle(folder, records, job)
        return "ended"
    if outcome is not None:
        records.restore(_request(folder), outcome)
        return "ended"
    if job.state is JobState.CANCELLING:
        state = cancel(folder, records, keeps_frames=None)
        return "ended" if state is JobState.CANCELLED else None
    return None


def _is_tidied(folder: JobFolder) -> bool:
    """Remove what attempts left, in place of a worker that died right before it did so.

    Where that fails no other job waits for it; the next round tries again.
    """
    try:
        folder.tidy()
    except (OSError, StoreUnavailable) as error:
        _LOGGER.warning("job %s leaves what is not its results: %s", folder.job_id, error)
        return False
    return True


def _request(folder: JobFolder) -> JobRequest:
    request = folder.request()
    if request.job_id != folder.job_id:
        raise ValueError(f"the folder of job {folder.job_id} has the request of another")
    return request
