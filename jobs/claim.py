"""The answer to a worker that wants a job."""

from dataclasses import dataclass
from datetime import datetime
from enum import StrEnum


class Refusal(StrEnum):
    """Why a job is not to be worked on."""

    UNKNOWN = "unknown"
    """No record: erased, or lost by Redis and soon restored by the reconciler. Drop the message."""
    ENDED = "ended"
    """Terminal already: a message delivered twice. Drop it."""
    HELD = "held"
    """Another worker has a live lease. Drop the message: if that worker dies, the reconciler
    enqueues the job again."""
    EXHAUSTED = "exhausted"
    """Every attempt was lost. The claim carries a token, only to record the failure with."""


@dataclass(frozen=True)
class Claim:
    """What a worker was given.

    token: the fence, larger than every token granted before for the job; None where refused,
        except for EXHAUSTED.
    attempt: which attempt this is, from 1.
    started_at: when a worker first started the job.
    traceparent: the trace that the job is part of.
    waited_s: how long no worker had held it.
    """

    token: int | None
    attempt: int
    started_at: datetime | None
    refusal: Refusal | None = None
    traceparent: str | None = None
    waited_s: float = 0.0

    @property
    def granted(self) -> bool:
        return self.refusal is None
