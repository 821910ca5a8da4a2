"""Words between service and worker: what a job folder stores, and what the queue carries."""

from datetime import datetime
from typing import Annotated, Any

from pydantic import BaseModel, ConfigDict, Field, StringConstraints

from schemas.base import FolderName, Name, WireModel
from schemas.job import Job, JobKind, JobState, Priority, Stage
from schemas.labels import LabelRequest
from schemas.options import Options
from schemas.problem import Problem
from schemas.study import ContourStudy
from schemas.vocabulary import View

ANONYMOUS = "anonymous"
"""The owner of what was submitted without a key."""

RECONSTRUCT_TASK = "neuralmri.reconstruct"
RECONSTRUCT_QUEUE = "neuralmri"

QUEUES = {Priority.INTERACTIVE: RECONSTRUCT_QUEUE, Priority.BATCH: f"{RECONSTRUCT_QUEUE}-batch"}
"""Names of queues. A worker looks into them in the order of their names: interactive first."""

MOST_WARNINGS = 101
"""That come with a study: a hundred, and how many more there are."""

HEARTBEAT_TASK = "neuralmri.heartbeat"
HEARTBEAT_QUEUE = "heartbeat-neuralmri"
"""Of its own, and first by name, so that a heartbeat does not wait behind the jobs that do."""


class ContourRequest(WireModel):
    """The body of `POST /v1/jobs/contours`."""

    study: ContourStudy
    options: Options = Field(default_factory=Options)
    warnings: list[Annotated[str, StringConstraints(max_length=1000)]] = Field(
        default_factory=list,
        max_length=MOST_WARNINGS,
        description="Of the reading of other files that the study was made from: the report has "
        "them too.",
    )


class Idempotency(WireModel):
    """By what a submission that is sent again is recognised."""

    key: str
    payload_sha256: str


class JobRequest(WireModel):
    """`request.json` in the job's folder: all that is needed to do, or redo, the job.

    A contour job's body is in `contours`; a label job's in `labels`, and its uploaded maps are
    files in `inputs/`, named by `files`. So are the reference meshes of either, by `references`,
    which maps the name of the surface that each is the truth of (`ED_lv_endo`) to its file.
    owner: whose job it is; a folder of before there were owners is everybody's.
    `restarted_from` is the job whose inputs these are too.
    """

    job_id: str
    kind: JobKind
    created_at: datetime
    priority: Priority = Priority.INTERACTIVE
    idempotency: Idempotency | None = None
    owner: Name = ANONYMOUS
    contours: ContourRequest | None = None
    labels: LabelRequest | None = None
    files: dict[View, str] = Field(default_factory=dict)
    references: dict[str, str] = Field(default_factory=dict)
    restarted_from: str | None = None
    batch_id: str | None = None
    name: FolderName | None = Field(default=None, description="What its batch calls it.")
    content_sha256: str | None = Field(
        default=None, description="Of study, options and files: what the results depend on."
    )
    retain_s: float | None = Field(
        default=None, gt=0.0, description="How long the job is kept after its end; null: for ever."
    )
    work: float = Field(
        default=1.0, gt=0.0, description="Expected, in standard fits of one frame; for estimates."
    )
    traceparent: str | None = Field(
        default=None, description="W3C trace context of the request that brought the job."
    )


class JobOwner(BaseModel):
    """Of `request.json`, only whose it is: a study is large, and this is asked often."""

    model_config = ConfigDict(extra="ignore", frozen=True, hide_input_in_errors=True)

    owner: Name = ANONYMOUS


class Outcome(WireModel):
    """`outcome.json` in the job's folder: how the job ended, written once."""

    state: JobState
    started_at: datetime | None
    finished_at: datetime
    attempt: int
    error: Problem | None = None
    code_version: str | None = Field(
        default=None,
        description="Of the code that made the results; null where none did, or it "
        "is not known which.",
    )
    stage_s: dict[Stage, float] = Field(
        default_factory=dict, description="Seconds that the last attempt spent in each stage."
    )


class ReconstructMessage(WireModel):
    """What the queue carries: a name, never the data; `priority` says which queue.

    The trace goes in the message's headers.
    """

    job_id: str
    priority: Priority = Priority.INTERACTIVE
    traceparent: str | None = None

    @classmethod
    def of_job(cls, job: Job, traceparent: str | None = None) -> "ReconstructMessage":
        """The message of a job that waits again; a worker finds the trace in its record too."""
        return cls(job_id=job.id, priority=job.priority, traceparent=traceparent)

    def as_kwargs(self) -> dict[str, Any]:
        return self.model_dump(mode="json", include={"job_id"})

    def as_headers(self) -> dict[str, str]:
        return {"traceparent": self.traceparent} if self.traceparent else {}
