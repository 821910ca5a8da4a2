"""Why a good submission is not accepted now, as problems with their remedies."""

from jobs.admission import Answer, Verdict
from jobs.estimate import retry_after_s
from schemas.problem import InputError, InternalError, ProblemType, ServiceError
from service.access import JobAccess

_POINTER = "/header/idempotency-key"


def key_reused() -> InputError:
    """The key is that of another request."""
    return InputError(
        ProblemType.IDEMPOTENCY_KEY_REUSED,
        "another request was sent under this Idempotency-Key. Remedy: send a request that differs "
        "under a key of its own; send the same one without a change to have its job.",
        pointer=_POINTER,
    )


def key_pending() -> InputError:
    """The key is that of a request whose folder is being written."""
    return InputError(
        ProblemType.IDEMPOTENCY_KEY_PENDING,
        "a request under this Idempotency-Key is still being taken in. Remedy: send it again after "
        "Retry-After to have its job.",
        pointer=_POINTER,
        status=409,
        retry_after_s=1,
    )


def no_room(answer: Answer, access: JobAccess) -> ServiceError:
    """The refusal of a request beyond a bound. Raises RedisError."""
    settings = access.settings
    wait_s = retry_after_s(access.line.next_start_s(), settings.retry_after_s)
    if answer.verdict is Verdict.TOO_MANY_JOBS:
        return InputError(
            ProblemType.TOO_MANY_JOBS,
            f"you have {settings.max_jobs_per_owner} unfinished jobs, as many as you may. Remedy: "
            "wait for one to end, or cancel one; nothing was accepted.",
            status=429,
            retry_after_s=wait_s,
        )
    return InternalError(
        ProblemType.QUEUE_FULL,
        f"{settings.max_queued_jobs} jobs wait already, as many as may; nothing was accepted. "
        "Remedy: send the request again after Retry-After.",
        status=503,
        retry_after_s=wait_s,
    )
