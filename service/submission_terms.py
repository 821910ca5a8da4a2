"""What comes with a submission beside its body."""

from typing import Annotated

from fastapi import Depends, Header, Query

from jobs.batch_store import BATCH_ID_PATTERN
from schemas.base import FolderName
from schemas.job import JobKind, Priority
from schemas.messages import Idempotency
from schemas.problem import InputError, ProblemType
from service.form_upload import FormUpload
from service.payload_hash import payload_sha256

_BATCH = "A batch of yours that the job joins."
_PRIORITY = (
    "Which jobs go first: a free worker takes an `interactive` job before any `batch` job, and of "
    "one priority the oldest. Where it is not given, `batch` for a job that joins a batch, else "
    "`interactive`. While interactive jobs keep coming, a batch job has its turn from "
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
        priority: Annotated[Priority | None, Query(description=_PRIORITY)] = None,
        batch: Annotated[str | None, Query(pattern=BATCH_ID_PATTERN, description=_BATCH)] = None,
        name: Annotated[
            FolderName | None, Query(description="What the batch is to call the job.")
        ] = None,
        idempotency_key: Annotated[
            str | None, Header(pattern=r"^[ -~]{1,255}$", description=_IDEMPOTENCY_KEY)
        ] = None,
    ) -> None:
        if name is not None and batch is None:
            raise InputError(
                ProblemType.INVALID_REQUEST,
                "a job has a name only within a batch. Remedy: send `batch` too, or no `name`.",
                pointer="/query/name",
            )
        self.priority = priority or (Priority.BATCH if batch else Priority.INTERACTIVE)
        self.batch = batch
        self.name = name
        self._key = idempotency_key

    def idempotency(self, kind: JobKind, upload: FormUpload) -> Idempotency | None:
        """Key and payload, where there is a key."""
        if self._key is None:
            return None
        membership = {"batch": self.batch, "name": self.name}
        joined = {what: text for what, text in membership.items() if text is not None}
        return Idempotency(
            key=self._key, payload_sha256=payload_sha256(kind, self.priority, upload, joined)
        )


Terms = Annotated[SubmissionTerms, Depends()]
