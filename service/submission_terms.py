"""What comes with a submission beside its body."""

from typing import Annotated

from fastapi import Depends, Header, Query

from schemas.job import JobKind, Priority
from schemas.messages import Idempotency
from service.form_upload import FormUpload
from service.payload_hash import payload_sha256

_PRIORITY = (
    "Which jobs go first: a free worker takes an `interactive` job before any `batch` job, and of "
    "one priority the oldest. While interactive jobs keep coming, a batch job has its turn from "
    "time to time."
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
    ) -> None:
        self.priority = priority
        self._key = idempotency_key

    def idempotency(self, kind: JobKind, upload: FormUpload) -> Idempotency | None:
        """Key and payload, where there is a key."""
        if self._key is None:
            return None
        return Idempotency(
            key=self._key, payload_sha256=payload_sha256(kind, self.priority, upload)
        )


Terms = Annotated[SubmissionTerms, Depends()]
