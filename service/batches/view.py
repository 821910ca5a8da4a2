"""A batch as its caller sees it: its record, and where each of its jobs stands now."""

from collections import Counter

from jobs.errors import JobGone
from schemas.batch import (
    Batch,
    BatchItem,
    BatchLinks,
    BatchMember,
    BatchRecord,
    BatchSummary,
    MemberState,
)
from schemas.job import Job
from service.access import JobAccess
from service.batches.joining import member_ids


def batch_members(access: JobAccess, record: BatchRecord) -> tuple[list[BatchMember], list[Job]]:
    """All studies of the batch in order, and the jobs that they are. Raises RedisError."""
    ids = member_ids(access, record)
    jobs = known_jobs(access, ids)
    pending = {request.job_id for request in record.pending}
    members = [
        _member(f"{place:06d}", item, jobs.get(item.job_id or ""), pending)
        for place, item in enumerate(record.items)
    ]
    planned = set(record.job_ids)
    for job_id in sorted(set(ids) - planned):
        if job := jobs.get(job_id):  # one that was erased has left the batch
            item = BatchItem(name=job.name, job_id=job_id)
            members.append(_member(job_id, item, job, pending))
    return members, list(jobs.values())


def known_jobs(access: JobAccess, ids: list[str]) -> dict[str, Job]:
    """Those of the jobs that are there. One that Redis has lost is read from its folder."""
    found = access.records.get_all(ids)
    for job_id in ids:
        folder = access.store.folder(job_id)
        if job_id not in found and folder.exists():
            try:
                access.records.restore(folder.request(), folder.outcome())
            except JobGone:
                continue
            found |= access.records.get_all([job_id])
    return {job_id: found[job_id] for job_id in ids if job_id in found}


def summary(record: BatchRecord, members: list[BatchMember], jobs: list[Job]) -> BatchSummary:
    """The batch as a whole, from all of its studies and jobs."""
    counts = Counter(member.state for member in members)
    here = f"/v1/batches/{record.batch_id}"
    done = [1.0 if job.state.is_terminal else job.progress.fraction for job in jobs]
    unaccepted = counts[MemberState.PENDING]
    return BatchSummary(
        id=record.batch_id,
        created_at=record.created_at,
        priority=record.priority,
        counts={state: counts[state] for state in MemberState},
        fraction=sum(done) / (len(done) + unaccepted) if done else 0.0,
        ended=all(member.state.is_ended for member in members),
        links=BatchLinks(
            self=here,
            cancel=f"{here}/cancel",
            jobs=f"/v1/jobs?batch={record.batch_id}",
            archive=f"{here}/artifacts.zip",
        ),
    )


def batch_of(
    access: JobAccess, record: BatchRecord, limit: int | None = None, cursor: str | None = None
) -> Batch:
    """The batch with up to `limit` studies, those after the key `cursor`."""
    members, jobs = batch_members(access, record)
    # Places in the body are short keys, ids of jobs that joined long ones.
    after = (len(cursor), cursor) if cursor else (0, "")
    left = [member for member in members if (len(member.key), member.key) > after]
    shown = left if limit is None else left[:limit]
    return Batch(
        **dict(summary(record, members, jobs)),
        studies=shown,
        next_cursor=shown[-1].key if shown and len(left) > len(shown) else None,
    )


def _member(key: str, item: BatchItem, job: Job | None, pending: set[str]) -> BatchMember:
    if job is not None:
        state = MemberState(job.state.value)
    elif item.job_id is None:
        state = MemberState.REFUSED
    else:
        state = MemberState.PENDING if item.job_id in pending else MemberState.ERASED
    return BatchMember(
        key=key,
        name=item.name,
        job_id=item.job_id,
        state=state,
        error=job.error if job else item.problem,
        retry_after_s=item.retry_after_s,
        links=job.links if job else None,
    )
