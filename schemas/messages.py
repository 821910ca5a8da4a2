"""Words between service and worker: what a job folder stores, and what the queue carries."""

from datetime import datetime
from typing import Any

from pydantic import Field

from schemas.base import WireModel
from schemas.job import JobKind, JobState, Stage
from schemas.labels import LabelRequest
from schemas.options import Options
from schemas.problem import Problem
from schemas.study import ContourStudy
from schemas.vocabulary import View

RECONSTRUCT_TASK = "neuralmri.reconstruct"
RECONSTRUCT_QUEUE = "neuralmri"

HEARTBEAT_TASK = "neuralmri.heartbeat"
HEARTBEAT_QUEUE = "neuralmri-heartbeat"
"""Of its own, so that a heartbeat does not wait behind the jobs that do."""


class ContourRequest(WireModel):
    """The body of `POST /v1/jobs/contours`."""

    study: ContourStudy
    options: Options = Field(default_factory=Options)


class JobRequest(WireModel):
    """`request.json` in the job's folder: all that is needed to do, or redo, the job.

    A contour job's body is in `contours`; a label job's in `labels`, and its uploaded maps are
    files in `inputs/`, named by `files`. So are the reference meshes of either, by `references`,
    which maps the name of the surface that each is the truth of (`ED_lv_endo`) to its file.
    """

    job_id: str
    kind: JobKind
    created_at: datetime
    contours: ContourRequest | None = None
    labels: LabelRequest | None = None
    files: dict[View, str] = Field(default_factory=dict)
    references: dict[str, str] = Field(default_factory=dict)
    traceparent: str | None = Field(
        default=None, description="W3C trace context of the request that brought the job."
    )


class Outcome(WireModel):
    """`outcome.json` in the job's folder: how the job ended, written once."""

    state: JobState
    started_at: datetime | None
    finished_at: datetime
    attempt: int
    error: Problem | None = None
    stage_s: dict[Stage, float] = Field(
        default_factory=dict, description="Seconds that the last attempt spent in each stage."
    )


class ReconstructMessage(WireModel):
    """What the queue carries: a name, never the data. The trace goes in the message's headers."""

    job_id: str
    traceparent: str | None = None

    def as_kwargs(self) -> dict[str, Any]:
        return self.model_dump(mode="json", include={"job_id"})

    def as_headers(self) -> dict[str, str]:
        return {"traceparent": self.traceparent} if self.traceparent else {}
