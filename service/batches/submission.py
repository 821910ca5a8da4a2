"""A batch that was received: planned, stored, and taken in, once for one idempotency key."""

from collections.abc import Callable, Sequence
from datetime import UTC, datetime

from intake.work import contour_work
from jobs.batch_store import batch_tail, new_batch_id
from jobs.content import content_sha256
from schemas.batch import BatchItem, BatchRecord
from schemas.job import JobKind
from schemas.messages import Idempotency, JobRequest
from schemas.problem import (
    Fault,
    InputError,
    InternalError,
    ProblemPart,
    ProblemType,
    ServiceError,
)
from service.access import JobAccess
from service.batches.book import still_taken_in
from service.batches.reading import ReadStudy
from service.batches.taking_in import refusal, take_in
from service.batches.terms import BatchTerms
from service.refusals import key_reused


def accept_batch(
    access: JobAccess,
    judge: Callable[[], Sequence[ReadStudy]],
    owner: str,
    terms: BatchTerms,
    idempotency: Idempotency | None,
) -> tuple[BatchRecord, bool]:
    """The batch, and whether the same request had made it before; then nothing is judged again.

    Its record, whole with every request, is on disk before the first study is accepted. Raises
    ServiceError where the key is another request's or every study is refused; then nothing is left.
    """
    tail = batch_tail(owner, idempotency.key if idempotency else None)
    planned = None
    if access.batches.with_tail(tail) is None:
        planned = _planned(access, judge(), owner, terms, idempotency, tail)
        if planned.items and not planned.job_ids:
            raise _all_refused(planned)
    with access.batches.turn(tail) as turn:
        found = access.batches.with_tail(tail)
        if found is not None and found.idempotency != idempotency:
            raise key_reused()
        record = found or planned
        if record is None:  # erased since it was looked for
            raise still_taken_in()
        if found is None:
            access.batches.write(record)
        record = take_in(access, record, turn)
        if record.items and not record.job_ids:
            access.batches.erase(record.batch_id)
            raise _all_refused(record)
    return record, found is not None


def _planned(
    access: JobAccess,
    studies: Sequence[ReadStudy],
    owner: str,
    terms: BatchTerms,
    idempotency: Idempotency | None,
    tail: str,
) -> BatchRecord:
    now, retain_s = datetime.now(tz=UTC), terms.retain_s(access.settings)
    batch_id = new_batch_id(tail)
    items: list[BatchItem] = []
    pending: list[JobRequest] = []
    for place, study in enumerate(studies):
        item = BatchItem(name=study.name)
        try:
            given = study.good()
        except ServiceError as refused:
            items.append(refusal(refused, access, place, item))
            continue
        request = JobRequest(
            job_id=access.store.new_id(),
            kind=JobKind.CONTOURS,
            created_at=now,
            priority=terms.priority,
            retain_s=retain_s,
            owner=owner,
            contours=given,
            batch_id=batch_id,
            name=study.name,
            work=contour_work(given.study, given.options),
        )
        request = request.model_copy(update={"content_sha256": content_sha256(request, {})})
        pending.append(request)
        items.append(item.model_copy(update={"job_id": request.job_id}))
    return BatchRecord(
        batch_id=batch_id,
        owner=owner,
        created_at=now,
        priority=terms.priority,
        idempotency=idempotency,
        items=items,
        pending=pending,
    )


_TYPES = {type_.uri: type_ for type_ in ProblemType}


def _all_refused(record: BatchRecord) -> ServiceError:
    """Of one kind, as each study's own refusal; of several, as a fault of the body."""
    problems = [item.problem for item in record.items if item.problem is not None]
    waits_s = [item.retry_after_s for item in record.items if item.retry_after_s is not None]
    first = problems[0]
    alike = {problem.type for problem in problems} == {first.type}
    family = InternalError if alike and first.fault is Fault.SERVICE else InputError
    return family(
        _TYPES[first.type] if alike else ProblemType.BATCH_REFUSED,
        f"none of the {len(problems)} studies was accepted, see `errors`. The first: "
        f"{first.detail}",
        pointer=first.pointer,
        status=first.status if alike else 422,
        errors=[ProblemPart(pointer=p.pointer or "", detail=p.detail) for p in problems],
        retry_after_s=max(waits_s, default=None),
    )
