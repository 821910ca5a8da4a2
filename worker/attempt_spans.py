"""The spans of one attempt: how long the job waited for it, the attempt itself, and its stages."""

import time
from contextlib import AbstractContextManager
from dataclasses import replace
from types import TracebackType

from jobs import spans
from jobs.claim import Claim
from jobs.spans import Span
from jobs.trace_context import TraceContext
from schemas.job import Progress, Stage
from schemas.messages import Outcome
from schemas.problem import Fault
from worker.observer import Observer

_UNFINISHED = "unfinished"
"""Handed back, taken over, or erased."""


class AttemptSpans(AbstractContextManager["AttemptSpans"]):
    """Entered once the job is claimed, left when the attempt is over. Costs nothing without spans.

    request: the place of the request that brought the job, None where that is not known.
    outcome: to be set where the attempt ended the job.
    """

    def __init__(self, job_id: str, claim: Claim, request: TraceContext | None) -> None:
        self.outcome: Outcome | None = None
        self._request_id = request.span_id if request else None
        self._place = request.child() if request else replace(TraceContext.begun(), is_sampled=True)
        self._about: dict[str, str | int] = {
            "neuralmri.job.id": job_id,
            "neuralmri.job.attempt": claim.attempt,
        }
        self._claimed_s = time.time()
        self._waited_s = claim.waited_s
        self._stage: Stage | None = None
        self._stage_since_s = self._claimed_s

    def __enter__(self) -> "AttemptSpans":
        self._record(
            "job wait", self._claimed_s - self._waited_s, self._claimed_s, self._request_id
        )
        return self

    def __exit__(
        self,
        kind: type[BaseException] | None,
        error: BaseException | None,
        trace: TracebackType | None,
    ) -> None:
        self._close_stage()
        outcome = self.outcome
        problem = outcome.error if outcome else None
        spans.record(
            Span(
                "job attempt",
                self._place,
                self._request_id,
                self._claimed_s,
                time.time(),
                attributes={
                    **self._about,
                    "neuralmri.job.outcome": outcome.state.value if outcome else _UNFINISHED,
                    **({"error.type": problem.type} if problem else {}),
                },
                failed=error is not None
                or (problem is not None and problem.fault is Fault.SERVICE),
            )
        )

    def entered(self, stage: Stage) -> None:
        """The attempt is in this stage from now on."""
        if stage is not self._stage:
            self._close_stage()
            self._stage, self._stage_since_s = stage, time.time()

    def _close_stage(self) -> None:
        if self._stage is not None and self._stage is not Stage.DONE:
            self._record(
                f"job {self._stage.value}", self._stage_since_s, time.time(), self._place.span_id
            )
        self._stage = None

    def _record(self, name: str, begun_s: float, ended_s: float, parent_id: str | None) -> None:
        place = self._place.child()
        spans.record(Span(name, place, parent_id, begun_s, ended_s, attributes=self._about))


class SpannedObserver:
    """Tells the spans of each stage, and passes everything on."""

    def __init__(self, observer: Observer, attempt: AttemptSpans) -> None:
        self._observer = observer
        self._attempt = attempt

    def advanced(self, progress: Progress) -> None:
        self._attempt.entered(progress.stage)
        self._observer.advanced(progress)

    def is_cancelled(self) -> bool:
        return self._observer.is_cancelled()
