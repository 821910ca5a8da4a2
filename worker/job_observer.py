"""The reconstruction's observer in a worker: progress to Redis, and the reasons to stop from it."""

import logging
import time
from collections.abc import Callable
from enum import StrEnum

from redis.exceptions import RedisError

from jobs import log_context
from jobs.errors import StaleToken
from jobs.records import JobRecords
from schemas.job import Progress, Stage
from worker.lease import Lease

_LOGGER = logging.getLogger(__name__)
_TELL_EVERY_S = 0.25
_ASK_EVERY_S = 0.3
_REST_AFTER_FAILURE_S = 5.0
_ETA_FROM_FRACTION = 0.05


class StopReason(StrEnum):
    """Why a computation was stopped."""

    CANCELLED = "cancelled"
    """Its caller asked."""
    LEASE_LOST = "lease_lost"
    """Another attempt has the job, or it was erased."""
    SHUTDOWN = "shutdown"
    """This worker closes; the job goes back to the queue."""


class JobObserver:
    """Watches one attempt. `stop_reason` says why it told the computation to stop, if it did.

    Redis is told at most four times a second, of each stage its first and last word besides and of
    all that is taken up from an earlier attempt, and asked at most every 0.3 s; when it fails, the
    computation goes on unwatched for a while.
    """

    def __init__(
        self, records: JobRecords, lease: Lease, is_shutting_down: Callable[[], bool]
    ) -> None:
        self.stop_reason: StopReason | None = None
        self._records = records
        self._lease = lease
        self._is_shutting_down = is_shutting_down
        self._since_s = time.monotonic()
        self._from_fraction = 0.0
        self._tell_at_s = 0.0
        self._ask_at_s = 0.0
        self._stage: Stage | None = None
        self._untold: Progress | None = None
        self._is_finishing = False

    def advanced(self, progress: Progress) -> None:
        now_s = time.monotonic()
        if self._lease.is_lost:
            return
        progress = self._with_eta(progress, now_s)
        is_new_stage = progress.stage is not self._stage
        if now_s < self._tell_at_s and not (is_new_stage or progress.is_taken_up):
            self._untold = progress
            return
        last_of_stage = self._untold if is_new_stage else None
        self._untold = None
        self._tell_at_s = now_s + _TELL_EVERY_S
        self._stage = log_context.current().stage = progress.stage
        try:
            for told in filter(None, (last_of_stage, progress)):
                self._records.advanced(self._lease.job_id, self._lease.token, told)
        except StaleToken:
            self._lease.lose()
        except RedisError as error:
            self._tell_at_s = now_s + _REST_AFTER_FAILURE_S
            _LOGGER.warning("job %s: progress was not recorded: %s", self._lease.job_id, error)

    def is_cancelled(self) -> bool:
        if self.stop_reason is None:
            self.stop_reason = self._reason_to_stop()
        return self.stop_reason is not None

    def keeps_found(self) -> bool:
        """Whether the job was cancelled so that its finished frames are kept. From then on neither
        that nor the worker's end stops it, for nobody would finish them: a plain cancellation does.
        """
        if self.stop_reason is StopReason.CANCELLED:
            self._is_finishing = self._keeps_frames()
            self.stop_reason = None if self._is_finishing else self.stop_reason
        return self._is_finishing and self.stop_reason is None

    def _reason_to_stop(self) -> StopReason | None:
        if self._lease.is_lost:
            return StopReason.LEASE_LOST
        if self._is_cancel_requested():
            return StopReason.CANCELLED
        is_leaving = self._is_shutting_down() and not self._is_finishing
        return StopReason.SHUTDOWN if is_leaving else None

    def _is_cancel_requested(self) -> bool:
        now_s = time.monotonic()
        if now_s < self._ask_at_s:
            return False
        self._ask_at_s = now_s + _ASK_EVERY_S
        try:
            if not self._records.is_cancel_requested(self._lease.job_id):
                return False
            return not (self._is_finishing and self._records.keeps_frames(self._lease.job_id))
        except RedisError as error:
            self._ask_at_s = now_s + _REST_AFTER_FAILURE_S
            _LOGGER.warning("job %s: cancellation is not seen: %s", self._lease.job_id, error)
            return False

    def _keeps_frames(self) -> bool:
        until_s = time.monotonic() + _REST_AFTER_FAILURE_S
        while True:
            try:
                return self._records.keeps_frames(self._lease.job_id)
            except RedisError as error:
                if time.monotonic() > until_s:
                    _LOGGER.warning("job %s: nothing is kept: %s", self._lease.job_id, error)
                    return False
                time.sleep(_ASK_EVERY_S)

    def _with_eta(self, progress: Progress, now_s: float) -> Progress:
        """Add what remains if the rest is as fast as what was, where nothing better is known.

        What an earlier attempt did says nothing of how fast this one is.
        """
        if progress.is_taken_up:
            self._since_s, self._from_fraction = now_s, progress.fraction
        done = progress.fraction - self._from_fraction
        if progress.eta_s is not None or done < _ETA_FROM_FRACTION:
            return progress
        eta_s = (now_s - self._since_s) * (1.0 - progress.fraction) / done
        return progress.model_copy(update={"eta_s": round(eta_s, 1)})
