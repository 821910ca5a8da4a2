"""A batch: many jobs under one parent, as its caller sends and sees it, and as it is stored."""

from datetime import datetime
from enum import StrEnum

from pydantic import Field

from schemas.base import FolderName, Name, WireModel
from schemas.job import JobState, Links, Priority
from schemas.messages import ANONYMOUS, Idempotency, JobRequest
from schemas.options import Options
from schemas.problem import Problem
from schemas.study import ContourStudy


class BatchStudy(WireModel):
    """One study of a batch; of a body in lines, one line."""

    name: FolderName | None = Field(
        default=None, description="What to call it in the batch, and its folder in the archive."
    )
    study: ContourStudy
    options: Options = Field(
        default_factory=Options, description="Over the batch's own, group by group."
    )


class BatchRequest(WireModel):
    """The body of `POST /v1/batches/contours`. Each study is judged and accepted by itself."""

    studies: list[BatchStudy] = Field(min_length=1)
    options: Options = Field(
        default_factory=Options, description="What every study has that does not say otherwise."
    )


class MemberState(StrEnum):
    """Where one study of a batch stands: as its job does, or why there is none."""

    PENDING = "pending"
    """Still being taken in."""
    REFUSED = "refused"
    QUEUED = JobState.QUEUED.value
    RUNNING = JobState.RUNNING.value
    CANCELLING = JobState.CANCELLING.value
    CANCELLED = JobState.CANCELLED.value
    SUCCEEDED = JobState.SUCCEEDED.value
    FAILED = JobState.FAILED.value
    ERASED = "erased"

    @property
    def is_ended(self) -> bool:
        return self not in (
            MemberState.PENDING,
            MemberState.QUEUED,
            MemberState.RUNNING,
            MemberState.CANCELLING,
        )


class BatchMember(WireModel):
    """One study of a batch."""

    key: str = Field(description="Its place: what `cursor` names.")
    name: FolderName | None = None
    job_id: str | None = Field(default=None, description="Null where no job was made of it.")
    state: MemberState
    error: Problem | None = Field(
        default=None,
        description="Why it was refused, with a pointer into the body; or why its job failed.",
    )
    retry_after_s: int | None = Field(
        default=None, ge=1, description="Of one refused for want of room: when to send it again."
    )
    links: Links | None = None


class BatchLinks(WireModel):
    """Where to go from a batch."""

    self: str
    cancel: str
    jobs: str
    archive: str


class BatchSummary(WireModel):
    """A batch as a whole."""

    id: str
    created_at: datetime
    priority: Priority
    counts: dict[MemberState, int] = Field(description="How many studies stand in each state.")
    fraction: float = Field(
        ge=0.0, le=1.0, description="How far its jobs are on average; an ended one counts 1."
    )
    ended: bool = Field(description="Whether no study is pending, queued, running or cancelling.")
    links: BatchLinks


class Batch(BatchSummary):
    """A batch and some of its studies, in the order of the body; those that joined come last."""

    studies: list[BatchMember]
    next_cursor: str | None = None


class BatchPage(WireModel):
    """Some of the caller's batches, newest first."""

    batches: list[BatchSummary]
    next_cursor: str | None = None


class BatchItem(WireModel):
    """What the record says of one study: the job planned for it, or the refusal."""

    name: FolderName | None = None
    job_id: str | None = None
    problem: Problem | None = None
    retry_after_s: int | None = None


class BatchRecord(WireModel):
    """`batches/<id>.json`: durable before any study of it is accepted.

    items: in the order of the body; none of a batch that was opened empty. pending: the requests
    that are not yet accepted nor refused, whole, so that whoever finds them can go on.
    """

    batch_id: str
    owner: Name = ANONYMOUS
    created_at: datetime
    priority: Priority = Priority.BATCH
    idempotency: Idempotency | None = None
    items: list[BatchItem] = Field(default_factory=list)
    pending: list[JobRequest] = Field(default_factory=list)

    @property
    def job_ids(self) -> list[str]:
        """Of the studies that were accepted, or are to be."""
        return [item.job_id for item in self.items if item.job_id is not None]

    def after(self, refused: dict[str, BatchItem], waiting: list[JobRequest]) -> "BatchRecord":
        """With refusals by the id of the job that was planned, and what is pending still."""
        items = [refused.get(item.job_id or "", item) for item in self.items]
        return self.model_copy(update={"items": items, "pending": waiting})
