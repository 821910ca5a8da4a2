"""One attempt on one job: claim, compute, publish, say how it ended.

The folder is the truth and the fence guards it: before anything is written that others see, the
lease is confirmed. Whatever happens in between, the job is left to be ended exactly once: by this
attempt, by a later one, or by the reconciler.
"""

import logging
from collections.abc import Callable
from dataclasses import dataclass
from functools import partial
from pathlib import Path
from typing import TypeVar

from celery.exceptions import SoftTimeLimitExceeded
from redis.exceptions import RedisError

from jobs import log_context
from jobs.claim import Claim, Refusal
from jobs.errors import AlreadyPublished, JobGone, StaleToken
from jobs.folder import JobFolder
from jobs.queue import JobQueue
from jobs.records import JobRecords
from jobs.store import JobStore
from jobs.store_errors import StoreUnavailable
from jobs.trace_context import TraceContext
from schemas.artifacts import Manifest
from schemas.job import JobState
from schemas.messages import Outcome, ReconstructMessage
from schemas.problem import InputError, InternalError, Problem
from worker.attempt_spans import AttemptSpans, SpannedObserver
from worker.failure import problem_of, timed_out, worker_lost
from worker.job_observer import JobObserver, StopReason
from worker.lease import Lease
from worker.observer import Cancelled, KeepsFound, Observer
from worker.patience import patiently
from worker.settings import WorkerSettings
from worker.stage_clock import StageClock

_LOGGER = logging.getLogger(__name__)
_Result = TypeVar("_Result")

Produce = Callable[[JobFolder, Path, Observer, KeepsFound], Manifest]
"""Computes a job into an empty folder. Raises ServiceError, Cancelled, or anything."""


@dataclass(frozen=True)
class Desk:
    """What a worker process works with."""

    store: JobStore
    records: JobRecords
    queue: JobQueue
    settings: WorkerSettings
    produce: Produce
    is_shutting_down: Callable[[], bool]
    code_version: str | None = None


def attempt(job_id: str, desk: Desk) -> None:
    """Work on a job if it is to be had, and return; the job's end is in its folder and record.

    Raises RedisError where the job cannot even be claimed; the reconciler enqueues it again.
    """
    settings = desk.settings
    claim = desk.records.claim(job_id, settings.lease_s, settings.max_attempts)
    if claim.token is None:
        _LOGGER.info("job %s is not to be had: %s", job_id, claim.refusal)
        return
    context = log_context.current()
    context.attempt = claim.attempt
    context.trace = TraceContext.parsed(claim.traceparent) or context.trace
    _LOGGER.info("job %s: attempt %s begins", job_id, claim.attempt)
    folder = desk.store.folder(job_id)
    with (
        AttemptSpans(job_id, claim, context.trace) as spans,
        Lease(desk.records, job_id, claim.token, settings.lease_s) as lease,
    ):
        observer = JobObserver(desk.records, lease, desk.is_shutting_down)
        clock = StageClock(SpannedObserver(observer, spans))
        ending = _Ending(folder, desk.records, claim, lease, clock, spans, observer, settings)
        try:
            if ending.patiently(folder.manifest) is not None:
                # An earlier attempt, the last one too, published and died before it could say so.
                ending.write(JobState.SUCCEEDED)
            elif claim.refusal is Refusal.EXHAUSTED:
                ending.failed(worker_lost(job_id, settings.max_attempts))
            else:
                _work(folder, desk, observer, ending)
        except JobGone:
            _LOGGER.info("job %s was erased while it was worked on", job_id)
        except StoreUnavailable as error:
            _hand_back(desk, lease, f"the store does not answer: {error}")


def _work(folder: JobFolder, desk: Desk, observer: JobObserver, ending: "_Ending") -> None:
    job_id = folder.job_id
    lease = ending.lease
    staging = folder.staging(lease.token)
    try:
        if observer.is_cancelled():
            raise Cancelled
        manifest = desk.produce(folder, staging, ending.clock, observer.keeps_found)
        # A part of the results is not what the same content would give again.
        code_version = desk.code_version if manifest.complete else None
        ending.succeeded(staging, manifest, code_version)
    except Cancelled:
        _stopped(observer.stop_reason, desk, lease, ending)
    except SoftTimeLimitExceeded:
        ending.failed(timed_out(job_id, desk.settings.soft_time_limit_s))
    except InputError as error:
        ending.failed(problem_of(error, job_id))
    except (JobGone, StoreUnavailable):
        raise
    except Exception as error:
        if not folder.exists():
            raise JobGone(f"job {job_id} was erased") from error
        _LOGGER.exception("job %s failed", job_id)
        # First, for where the disk is full its space is what saying so needs.
        folder.drop_staging(staging)
        ending.failed(problem_of(error, job_id))
    finally:
        folder.drop_staging(staging)


def _stopped(reason: StopReason | None, desk: Desk, lease: Lease, ending: "_Ending") -> None:
    if reason is StopReason.CANCELLED:
        ending.write(JobState.CANCELLED)
    elif reason is StopReason.SHUTDOWN:
        _hand_back(desk, lease, "this worker closes")
    else:
        _LOGGER.info("job %s is another attempt's now", lease.job_id)


def _hand_back(desk: Desk, lease: Lease, why: str) -> None:
    """Return the job to the queue. Where that fails, the reconciler does it once the lease ends."""
    trace = log_context.current().trace
    traceparent = trace.header() if trace else None
    try:
        desk.records.released(lease.job_id, lease.token)
        job = desk.records.get(lease.job_id)
        if job is not None:
            desk.queue.enqueue(ReconstructMessage.of_job(job, traceparent))
    except (RedisError, InternalError, StaleToken) as error:
        _LOGGER.warning("job %s was not handed back: %s", lease.job_id, error)
    else:
        _LOGGER.info("job %s was handed back: %s", lease.job_id, why)


@dataclass(frozen=True)
class _Ending:
    """The ways in which this attempt may end the job, each only while the job is ours."""

    folder: JobFolder
    records: JobRecords
    claim: Claim
    lease: Lease
    clock: StageClock
    spans: AttemptSpans
    observer: JobObserver
    settings: WorkerSettings

    def patiently(self, step: Callable[[], _Result]) -> _Result:
        """Take a step in the store. Raises StoreUnavailable where waiting did not help."""
        return patiently(step, self.observer.is_cancelled, self.settings.store_patience_s)

    def succeeded(self, staging: Path, manifest: Manifest, code_version: str | None) -> None:
        if not self.lease.confirm():
            return
        try:
            self.patiently(partial(self.folder.publish, staging, manifest))
        except AlreadyPublished:
            _LOGGER.info("job %s: another attempt's results stand", self.folder.job_id)
            code_version = None
        self.write(JobState.SUCCEEDED, code_version=code_version)

    def failed(self, problem: Problem) -> None:
        trace = log_context.current().trace
        known = {"trace_id": trace.trace_id if trace else None}
        self.write(JobState.FAILED, problem.model_copy(update=known))

    def write(
        self, state: JobState, error: Problem | None = None, code_version: str | None = None
    ) -> None:
        """Write the outcome, then record whichever outcome stands.

        code_version: of the code that made the results, where that is this attempt's.
        """
        if not self.lease.confirm():
            return
        outcome = Outcome(
            state=state,
            started_at=self.claim.started_at,
            finished_at=self.records.now(),
            attempt=self.claim.attempt,
            error=error,
            stage_s=self.clock.stage_s(),
            code_version=code_version,
        )
        outcome = self.patiently(partial(self.folder.write_outcome, outcome))
        self.spans.outcome = outcome
        try:
            self.records.finished(self.folder.job_id, self.lease.token, outcome)
        except (RedisError, StaleToken) as trouble:
            # The folder says how the job ended; the reconciler tells Redis.
            _LOGGER.warning("job %s: its end was not recorded: %s", self.folder.job_id, trouble)
        _LOGGER.info("job %s ended: %s", self.folder.job_id, outcome.state)
        try:
            self.folder.tidy()
        except StoreUnavailable as trouble:
            _LOGGER.warning("job %s leaves what is not its results: %s", self.lease.job_id, trouble)
