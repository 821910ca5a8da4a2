"""The job as its caller sees it: state, progress, times, error, links."""

from datetime import datetime
from enum import StrEnum

from pydantic import Field

from schemas.base import FolderName, Name, WireModel
from schemas.problem import Problem


class JobKind(StrEnum):
    """What was submitted."""

    CONTOURS = "contours"
    LABELS = "labels"


class Priority(StrEnum):
    """Which jobs go before which; within one priority, the older first."""

    INTERACTIVE = "interactive"
    BATCH = "batch"


class JobState(StrEnum):
    """Where a job stands. Terminal states never change."""

    QUEUED = "queued"
    RUNNING = "running"
    CANCELLING = "cancelling"
    CANCELLED = "cancelled"
    SUCCEEDED = "succeeded"
    FAILED = "failed"

    @property
    def is_terminal(self) -> bool:
        return self in (JobState.CANCELLED, JobState.SUCCEEDED, JobState.FAILED)

    def may_become(self, other: "JobState") -> bool:
        return other in _NEXT[self]


_NEXT: dict[JobState, frozenset[JobState]] = {
    JobState.QUEUED: frozenset(
        {JobState.RUNNING, JobState.CANCELLING, JobState.CANCELLED, JobState.FAILED}
    ),
    JobState.RUNNING: frozenset(
        {JobState.QUEUED, JobState.CANCELLING, JobState.SUCCEEDED, JobState.FAILED}
    ),
    JobState.CANCELLING: frozenset({JobState.CANCELLED, JobState.SUCCEEDED, JobState.FAILED}),
    JobState.CANCELLED: frozenset(),
    JobState.SUCCEEDED: frozenset(),
    JobState.FAILED: frozenset(),
}


class Stage(StrEnum):
    """What a job is doing."""

    WAITING = "waiting"
    READING = "reading"
    FITTING = "fitting"
    MESHING = "meshing"
    REFITTING = "refitting"
    MEASURING = "measuring"
    WRITING = "writing"
    DONE = "done"


class Progress(WireModel):
    """How far a job has come."""

    fraction: float = Field(default=0.0, ge=0.0, le=1.0)
    stage: Stage = Stage.WAITING
    frame: Name | None = None
    level: int | None = Field(default=None, ge=0)
    iteration: int | None = Field(
        default=None,
        ge=0,
        description="Within the level. Null beside a level that an earlier attempt had finished: "
        "this one goes on after it.",
    )
    loss: float | None = None
    eta_s: float | None = Field(default=None, ge=0.0)

    @property
    def is_taken_up(self) -> bool:
        """Whether an earlier attempt came this far, and this one goes on from there."""
        return self.level is not None and self.iteration is None


class Links(WireModel):
    """Where to go from a job."""

    self: str
    cancel: str
    events: str | None = None
    report: str
    artifacts: str


class Job(WireModel):
    """One accepted request."""

    id: str
    kind: JobKind
    state: JobState
    priority: Priority = Priority.INTERACTIVE
    queue_position: int | None = Field(
        default=None, ge=0, description="While queued: how many jobs will be started before it."
    )
    estimated_start_s: float | None = Field(
        default=None,
        ge=0.0,
        description="While queued: seconds until a worker starts it, by the pace of the last "
        "jobs. Null before there is one to go by, and while no worker is alive.",
    )
    progress: Progress = Field(default_factory=Progress)
    created_at: datetime
    started_at: datetime | None = None
    finished_at: datetime | None = None
    attempt: int = Field(default=0, ge=0, description="How often a worker has started it.")
    error: Problem | None = None
    expires_at: datetime | None = Field(
        default=None, description="When an ended job will be erased; null: never, or not ended."
    )
    restarted_from: str | None = Field(
        default=None, description="The job that this one does anew; it may have been erased since."
    )
    trace_id: str | None = Field(
        default=None, description="Of the request that brought it: what the logs have it under."
    )
    batch_id: str | None = Field(default=None, description="The batch that it is part of.")
    name: FolderName | None = Field(default=None, description="What its batch calls it.")
    links: Links


class JobPage(WireModel):
    """Some of the caller's jobs, newest first."""

    jobs: list[Job]
    next_cursor: str | None = None
