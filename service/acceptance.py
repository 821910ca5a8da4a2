"""Accepting a submission that was found good, once, and saying so."""

import logging
import time
from collections.abc import Mapping

from fastapi import Response
from redis.exceptions import RedisError

from jobs.admission import Answer, Verdict
from jobs.content import content_sha256
from jobs.estimate import retry_after_s
from jobs.folder import Source
from jobs.reconcile import reconcile
from jobs.submission import submit
from schemas.job import Job
from schemas.messages import JobRequest
from service.access import JobAccess
from service.batches.joining import require_room
from service.refusals import key_pending, key_reused, no_room
from service.reuse import reusable_job

log = logging.getLogger("neuralmri.service")

_PATIENCE_S = 2.0
_LOOK_EVERY_S = 0.02


def accept(
    access: JobAccess,
    request: JobRequest,
    inputs: Mapping[str, Source],
    owner: str,
    response: Response,
    *,
    reuse: bool = False,
) -> Job:
    """Accept the job, or find the one that the same request made before; the headers say which.

    With `reuse`, a job of before that has the same results will do, if the request's key is not
    known: the response's status is 200 then.

    Raises ServiceError where the queue or the owner has no room, the idempotency key is another
    request's, or a request with that key is not taken in within two seconds.
    """
    if request.idempotency is not None and not access.records.wholeness.is_certain():
        # Redis has lost something, perhaps this very key: have it back from the folders first.
        reconcile(access.store, access.records, access.queue, access.settings.lost_after_s)
    request = request.model_copy(update={"content_sha256": content_sha256(request, inputs)})
    if reuse and not access.admission.knows(request, owner):
        earlier = reusable_job(access, request, owner)
        if earlier is not None:
            response.status_code = 200
            response.headers["Location"] = earlier.links.self
            response.headers["Result-Reused"] = "true"
            return earlier
    if request.batch_id is not None:
        require_room(access, request.batch_id, owner)
    patient_until_s = time.monotonic() + _PATIENCE_S
    while True:
        answer = access.admission.ask(request, owner)
        if answer.verdict is Verdict.ADMITTED:
            job = submitted(access, request, inputs, owner)
            break
        if answer.holder is None:
            raise no_room(answer, access)
        if request.idempotency and answer.payload_sha256 != request.idempotency.payload_sha256:
            raise key_reused()
        found = _replayed(access, answer)
        if found is not None:
            job = found
            response.headers["Idempotency-Replayed"] = "true"
            break
        if time.monotonic() > patient_until_s:
            raise key_pending()
        time.sleep(_LOOK_EVERY_S)
    job = _placed(access, job)
    wait_s = max(access.settings.poll_after_s, job.estimated_start_s or 0.0)
    response.headers["Location"] = job.links.self
    response.headers["Retry-After"] = str(retry_after_s(wait_s, access.settings.poll_after_s))
    return job


def submitted(
    access: JobAccess, request: JobRequest, inputs: Mapping[str, Source], owner: str
) -> Job:
    """The job, whose place is held, accepted; where it is not, place and key are free again."""
    try:
        return submit(access.store, access.records, access.queue, request, inputs, owner)
    except BaseException:
        try:
            access.admission.withdraw(request, owner)
        except RedisError as error:
            log.warning("a place is held in vain for a while: %s", error)
        raise


def _replayed(access: JobAccess, answer: Answer) -> Job | None:
    """The job that has the key; None where it is still being written, or was erased."""
    if answer.verdict is Verdict.KEY_PENDING or answer.holder is None:
        return None
    if access.store.folder(answer.holder).exists():
        return access.records.get(answer.holder)
    # A record is made after its folder, so this job was erased. Redis did not hear of it yet.
    access.records.forget(answer.holder)
    return None


def _placed(access: JobAccess, job: Job) -> Job:
    """The job with its place in the line; without where Redis fails, since it is accepted."""
    try:
        return access.line.placed([job])[0]
    except RedisError as error:
        log.warning("job %s was accepted, its place is not known: %s", job.id, error)
        return job
