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
from service.retain_term import RetainS, retained_s
from service.settings import ServiceSettings

_BATCH = "A batch of yours that the job joins."
_PRIORITY = (
    "Which jobs go first: a free worker takes an `interactive` job before any `batch` job, and of "
    "one priority the oldest. Where it is not given, `batch` for a job that joins a batch, else "
    "`interactive`. While interactive jobs keep coming, a batch job has its turn from "
    "time to time."
)
_REUSE = (
    "Have an earlier job of yours, where one has succeeded with the same study, options and files "
    "by the code that the workers have now: 200 and that job. Otherwise a new one is accepted. "
    "Not together with `batch`."
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
        reuse: Annotated[bool, Query(description=_REUSE)] = False,
        retain_s: RetainS = None,
    ) -> None:
        if name is not None and batch is None:
            raise InputError(
                ProblemType.INVALID_REQUEST,
                "a job has a name only within a batch. Remedy: send `batch` too, or no `name`.",
                pointer="/query/name",
            )
        if reuse and batch is not None:
            raise InputError(
                ProblemType.INVALID_REQUEST,
                "an earlier job cannot join a batch. Remedy: send `reuse` or `batch`, not both.",
                pointer="/query/reuse",
            )
        self.priority = priority or (Priority.BATCH if batch else Priority.INTERACTIVE)
        self.batch = batch
        self.name = name
        self.reuse = reuse
        self._key = idempotency_key
        self._retain_s = retain_s

    def retain_s(self, settings: ServiceSettings) -> float | None:
        """How long the job is to be kept after its end; None for ever. Raises InputError."""
        return retained_s(self._retain_s, settings)

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
        retain_s = None if self._retain_s is None else str(self._retain_s)
        terms = {"batch": self.batch, "name": self.name, "retain_s": retain_s}
        return {what: text for what, text in terms.items() if text is not None}


Terms = Annotated[SubmissionTerms, Depends()]
