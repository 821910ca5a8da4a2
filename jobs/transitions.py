"""The steps of a job's life: a record and the Redis clock in, a record out. Nothing else happens.

Each obeys `JobState.may_become`. A step by a worker carries its token, and raises StaleToken when
that is no longer the newest.
"""

from dataclasses import replace

from jobs.claim import Refusal
from jobs.errors import StaleToken
from jobs.record import Record, instant
from schemas.job import JobState, Progress
from schemas.messages import Outcome


def refusal(record: Record | None, now_us: int, max_attempts: int) -> Refusal | None:
    """Why the job is not to be worked on; None where it is."""
    if record is None:
        return Refusal.UNKNOWN
    if record.state.is_terminal:
        return Refusal.ENDED
    if record.is_held(now_us):
        return Refusal.HELD
    if record.state is not JobState.CANCELLING and record.attempt >= max_attempts:
        return Refusal.EXHAUSTED
    return None


def leased(record: Record, now_us: int, lease_s: float) -> Record:
    """Held under a new fence, larger than all before it even where Redis lost those."""
    return _for(lease_s, replace(record, token=max(record.token + 1, now_us)), now_us)


def started(record: Record, now_us: int) -> Record:
    """Being worked on, by one attempt more. A cancelling job is only given an end."""
    if record.state is JobState.CANCELLING:
        return record
    return replace(
        record.to(JobState.RUNNING),
        attempt=record.attempt + 1,
        started_at=record.started_at or instant(now_us),
        progress=Progress(),
    )


def renewed(record: Record | None, token: int, now_us: int, lease_s: float) -> Record:
    """Held for `lease_s` from now."""
    return _for(lease_s, _held(record, token), now_us)


def advanced(record: Record | None, token: int, progress: Progress) -> Record:
    """Further on by its worker's word."""
    return replace(_held(record, token), progress=progress)


def finished(record: Record | None, token: int, outcome: Outcome) -> Record:
    """Ended by its worker. Saying it twice with one token is saying it once."""
    if record and record.token == token and record.state is outcome.state:
        return record
    held = _held(record, token)
    if held.state is JobState.QUEUED and outcome.state is JobState.SUCCEEDED:
        # The work was done: by the last attempt allowed, lost before it could say so.
        held = held.to(JobState.RUNNING)
    return held.to(outcome.state).ended(outcome)


def released(record: Record | None, token: int, now_us: int) -> Record:
    """Handed back unfinished. It does not count as an attempt: only lost workers do."""
    held = replace(
        _held(record, token),
        token=token + 1,
        free_from_us=now_us,
        lease_us=0,
        was_released=True,
    )
    if held.state is not JobState.RUNNING:
        return held
    return replace(held.to(JobState.QUEUED), attempt=held.attempt - 1, progress=Progress())


def cancel_requested(record: Record, now_us: int, *, keeps_frames: bool | None = False) -> Record:
    """Cancelling while a worker holds it, cancelled at once where none does.

    keeps_frames: Whether the frames that it has finished are wanted. The last word holds; None is
    none.
    """
    if record.state.is_terminal:
        return record
    if record.is_held(now_us):
        keeps = record.keeps_frames if keeps_frames is None else keeps_frames
        return replace(record.to(JobState.CANCELLING), keeps_frames=keeps)
    if record.state is JobState.RUNNING:  # its worker is lost, and has no right to go on
        record = record.to(JobState.CANCELLING)
    return replace(
        record.to(JobState.CANCELLED), token=record.token + 1, finished_at=instant(now_us)
    )


def is_lost(record: Record | None, now_us: int, after_s: float) -> bool:
    """Whether the job wants a worker and none has held it for `after_s`."""
    return (
        record is not None
        and record.state in (JobState.QUEUED, JobState.RUNNING)
        and record.free_from_us + _us(after_s) < now_us
    )


def reclaimed(record: Record, now_us: int) -> Record:
    """Taken back from whoever held it last."""
    return replace(
        record.to(JobState.QUEUED), token=record.token + 1, free_from_us=now_us, lease_us=0
    )


def by_the_clock(record: Record, now_us: int) -> Record:
    """The same, where the clock went back and left an instant that no lease could have reached: a
    worker that lives renews its lease within it, and one that does not is missed soon after.
    """
    latest_us = now_us + record.lease_us
    return record if record.free_from_us <= latest_us else replace(record, free_from_us=latest_us)


def _held(record: Record | None, token: int) -> Record:
    if record is None or record.token != token or record.state.is_terminal:
        raise StaleToken("the job was taken over, cancelled or erased meanwhile")
    return record


def _for(lease_s: float, record: Record, now_us: int) -> Record:
    """Held for so long from now."""
    return replace(record, free_from_us=now_us + _us(lease_s), lease_us=_us(lease_s))


def _us(seconds: float) -> int:
    return int(seconds * 1e6)
