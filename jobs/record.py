"""What Redis knows about one job, and how that is spelled in a Redis hash."""

from collections.abc import Mapping
from dataclasses import dataclass, field, replace
from datetime import UTC, datetime, timedelta

from pydantic import TypeAdapter

from jobs.errors import IllegalTransition
from jobs.trace_context import TraceContext
from schemas.job import Job, JobKind, JobState, Links, Priority, Progress, Stage
from schemas.messages import Idempotency, JobRequest, Outcome
from schemas.problem import Problem

_LONGEST_LEASE_US = 3600 * 1_000_000
_STAGE_S = TypeAdapter(dict[Stage, float])


@dataclass(frozen=True)
class Record:
    """One job's live state.

    token: the newest fence granted, 0 before the first.
    free_from_us: from this instant of the Redis clock (Unix time, microseconds) no worker holds the
        job. In the future while a lease lives; in the past it says how long the job has lain.
    lease_us: how long a lease was granted last, 0 while nobody has one. What lies further ahead
        than that was written before the clock went back.
    keeps_frames: whether the frames that a cancelling job has finished are to be its results.
    was_released: whether a worker has handed it back; what the next one takes tells of a part only.
    """

    job_id: str
    owner: str
    kind: JobKind
    state: JobState
    created_at: datetime
    started_at: datetime | None = None
    finished_at: datetime | None = None
    attempt: int = 0
    progress: Progress = field(default_factory=Progress)
    error: Problem | None = None
    restarted_from: str | None = None
    token: int = 0
    free_from_us: int = 0
    lease_us: int = 0
    was_released: bool = False
    priority: Priority = Priority.INTERACTIVE
    idempotency: Idempotency | None = None
    traceparent: str | None = None
    stage_s: Mapping[Stage, float] = field(default_factory=dict)
    batch_id: str | None = None
    name: str | None = None
    work: float = 1.0
    retain_s: float | None = None
    content_sha256: str | None = None
    code_version: str | None = None
    keeps_frames: bool = False

    @classmethod
    def of_request(cls, request: JobRequest, now_us: int) -> "Record":
        return cls(
            job_id=request.job_id,
            owner=request.owner,
            kind=request.kind,
            state=JobState.QUEUED,
            created_at=request.created_at,
            restarted_from=request.restarted_from,
            free_from_us=now_us,
            priority=request.priority,
            idempotency=request.idempotency,
            traceparent=request.traceparent,
            batch_id=request.batch_id,
            name=request.name,
            work=request.work,
            retain_s=request.retain_s,
            content_sha256=request.content_sha256,
        )

    @classmethod
    def of_fields(cls, job_id: str, fields: Mapping[str, str]) -> "Record":
        return cls(
            job_id=job_id,
            owner=fields["owner"],
            kind=JobKind(fields["kind"]),
            state=JobState(fields["state"]),
            created_at=datetime.fromisoformat(fields["created_at"]),
            started_at=_instant(fields["started_at"]),
            finished_at=_instant(fields["finished_at"]),
            attempt=int(fields["attempt"]),
            progress=Progress.model_validate_json(fields["progress"]),
            error=Problem.model_validate_json(fields["error"]) if fields["error"] else None,
            restarted_from=fields.get("restarted_from") or None,
            token=int(fields["token"]),
            free_from_us=int(fields["free_from_us"]),
            # These are not there in records of an older release.
            was_released=fields.get("was_released") == "1",
            lease_us=int(fields.get("lease_us", _LONGEST_LEASE_US)),
            priority=Priority(fields.get("priority", Priority.INTERACTIVE)),
            idempotency=_idempotency(fields.get("idempotency", "")),
            traceparent=fields.get("traceparent") or None,
            stage_s=_STAGE_S.validate_json(fields.get("stage_s", "{}")),
            batch_id=fields.get("batch_id") or None,
            name=fields.get("name") or None,
            work=float(fields.get("work", 1.0)),
            retain_s=float(fields["retain_s"]) if fields.get("retain_s") else None,
            content_sha256=fields.get("content_sha256") or None,
            code_version=fields.get("code_version") or None,
            keeps_frames=fields.get("keeps_frames") == "1",
        )

    def fields(self) -> dict[str, str]:
        return {
            "owner": self.owner,
            "kind": self.kind.value,
            "state": self.state.value,
            "created_at": self.created_at.isoformat(),
            "started_at": self.started_at.isoformat() if self.started_at else "",
            "finished_at": self.finished_at.isoformat() if self.finished_at else "",
            "attempt": str(self.attempt),
            "progress": self.progress.model_dump_json(),
            "error": self.error.model_dump_json() if self.error else "",
            "restarted_from": self.restarted_from or "",
            "token": str(self.token),
            "free_from_us": str(self.free_from_us),
            "lease_us": str(self.lease_us),
            "was_released": "1" if self.was_released else "",
            "priority": self.priority.value,
            "idempotency": self.idempotency.model_dump_json() if self.idempotency else "",
            "traceparent": self.traceparent or "",
            "stage_s": _STAGE_S.dump_json(dict(self.stage_s)).decode(),
            "batch_id": self.batch_id or "",
            "name": self.name or "",
            "work": str(self.work),
            "content_sha256": self.content_sha256 or "",
            "code_version": self.code_version or "",
            "keeps_frames": "1" if self.keeps_frames else "",
            "retain_s": "" if self.retain_s is None else str(self.retain_s),
        }

    @property
    def expires_at(self) -> datetime | None:
        """When it is to be erased; None for never, or not yet ended."""
        if self.finished_at is None or self.retain_s is None or not self.state.is_terminal:
            return None
        return self.finished_at + timedelta(seconds=self.retain_s)

    def is_held(self, now_us: int) -> bool:
        return not self.state.is_terminal and now_us < self.free_from_us <= now_us + self.lease_us

    def to(self, state: JobState) -> "Record":
        """This record in another state. Raises IllegalTransition."""
        if state is not self.state and not self.state.may_become(state):
            raise IllegalTransition(f"a {self.state} job cannot become {state}")
        return replace(self, state=state)

    def ended(self, outcome: Outcome) -> "Record":
        """This record with the outcome's truth, whatever it held: the folder is right."""
        progress = self.progress
        if outcome.state is JobState.SUCCEEDED:
            progress = Progress(fraction=1.0, stage=Stage.DONE)
        return replace(
            self,
            state=outcome.state,
            started_at=outcome.started_at,
            finished_at=outcome.finished_at,
            attempt=outcome.attempt,
            error=outcome.error,
            progress=progress,
            stage_s=outcome.stage_s,
            code_version=outcome.code_version,
        )

    def job(self) -> Job:
        """The job as its caller sees it."""
        here = f"/v1/jobs/{self.job_id}"
        trace = TraceContext.parsed(self.traceparent)
        return Job(
            id=self.job_id,
            kind=self.kind,
            state=self.state,
            priority=self.priority,
            progress=self.progress,
            created_at=self.created_at,
            started_at=self.started_at,
            finished_at=self.finished_at,
            attempt=self.attempt,
            error=self.error,
            expires_at=self.expires_at,
            restarted_from=self.restarted_from,
            trace_id=trace.trace_id if trace else None,
            batch_id=self.batch_id,
            name=self.name,
            links=Links(
                self=here,
                cancel=f"{here}/cancel",
                events=f"{here}/events",
                report=f"{here}/report",
                artifacts=f"{here}/artifacts",
            ),
        )


def instant(now_us: int) -> datetime:
    """A Redis clock reading as a time."""
    return datetime.fromtimestamp(now_us / 1e6, tz=UTC)


def _instant(text: str) -> datetime | None:
    return datetime.fromisoformat(text) if text else None


def _idempotency(text: str) -> Idempotency | None:
    return Idempotency.model_validate_json(text) if text else None
