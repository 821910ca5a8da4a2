"""What comes with a submission beside its body."""

from typing import Annotated

from fastapi import Depends, Header, Query

from schemas.job import JobKind, Priority
from schemas.messages import Idempotency
from schemas.problem import InputError, ProblemType
from service.form_upload import FormUpload
from service.payload_hash import payload_sha256
from service.settings import ServiceSettings

_CENTURY_S = 36525 * 86400

_PRIORITY = (
    "Which jobs go first: a free worker takes an `interactive` job before any `batch` job, and of "
    "one priority the oldest. While interactive jobs keep coming, a batch job has its turn from "
    "time to time."
)
_REUSE = (
    "Have an earlier job of yours, where one has succeeded with the same study, options and files "
    "by the code that the workers have now: 200 and that job. Otherwise a new one is accepted."
)
_RETAIN_S = (
    "Erase the job so many seconds after its end, however it ends. No more than the service keeps "
    "jobs for; left out, that long."
)
_IDEMPOTENCY_KEY = (
    "A name of your own for this request, best a UUID, to send it again by: whatever became of the "
    "answer, one key makes one job. Printable ASCII, taken as it is. It is forgotten with the job."
)


class SubmissionTerms:
    """How a request wants to be treated, as its parameters say."""

    def __init__(
        self,
        priority: Annotated[Priority, Query(description=_PRIORITY)] = Priority.INTERACTIVE,
        idempotency_key: Annotated[
            str | None, Header(pattern=r"^[ -~]{1,255}$", description=_IDEMPOTENCY_KEY)
        ] = None,
        reuse: Annotated[bool, Query(description=_REUSE)] = False,
        retain_s: Annotated[int | None, Query(ge=60, le=_CENTURY_S, description=_RETAIN_S)] = None,
    ) -> None:
        self.priority = priority
        self.reuse = reuse
        self._key = idempotency_key
        self._retain_s = retain_s

    def retain_s(self, settings: ServiceSettings) -> float | None:
        """How long the job is to be kept after its end; None for ever. Raises InputError."""
        days = settings.retention_days
        longest_s = None if days is None else days * 86400.0
        if self._retain_s is None or longest_s is None:
            return longest_s if self._retain_s is None else float(self._retain_s)
        if self._retain_s > longest_s:
            raise InputError(
                ProblemType.INVALID_REQUEST,
                f"this service keeps jobs for {longest_s:.0f} s after their end. Remedy: ask for "
                "less in retain_s, or leave it out; fetch the results before they expire.",
                pointer="/query/retain_s",
            )
        return float(self._retain_s)

    def idempotency(self, kind: JobKind, upload: FormUpload) -> Idempotency | None:
        """Key and payload, where there is a key."""
        if self._key is None:
            return None
        return Idempotency(
            key=self._key,
            payload_sha256=payload_sha256(kind, self.priority, upload, self._named()),
        )

    def _named(self) -> dict[str, str]:
        """Terms that the request names, beside the priority."""
        return {"retain_s": str(self._retain_s)} if self._retain_s is not None else {}


Terms = Annotated[SubmissionTerms, Depends()]
