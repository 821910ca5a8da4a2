"""Erasing jobs that have expired, with a line in the audit log as the proof of each."""

import logging
from datetime import UTC, datetime

from jobs import ending
from jobs.errors import JobGone
from jobs.expiry import due, expires_at
from jobs.folder import JobFolder
from jobs.record import instant
from jobs.redis_clock import now_us
from jobs.store_errors import StoreUnavailable
from schemas.audit import Action, AuditEntry, AuditOutcome
from service.access import JobAccess
from service.audit_log import AuditLog
from service.clocks import Clocks

log = logging.getLogger("neuralmri.retention")

ACTOR = "retention"

_AT_ONCE = 1000
"""Jobs of one round, so that reconciling is not held up; the next round goes on."""


class Retention:
    """Any number of processes may do this at any time: erasing is erasing however often it is done.

    The line is written first. A crash in between leaves the job, which the next round erases with
    a line of its own: proofs may come twice and are never missing.
    """

    def __init__(self, access: JobAccess, audit: AuditLog) -> None:
        self._access = access
        self._audit = audit
        self._clocks = Clocks()

    def erase_expired(self) -> int:
        """Erase what has expired, and return how many. Nothing while the clock is in doubt.

        Raises RedisError.
        """
        redis = self._access.redis
        now = instant(now_us(redis))
        expired = due(redis, now, _AT_ONCE)
        if not expired:
            return 0
        doubt = self._clocks.doubt(now)
        if doubt is not None:
            log.error("%d jobs are due and none is erased: %s", len(expired), doubt)
            return 0
        return sum(self._erased(self._access.store.folder(job_id), now) for job_id in expired)

    def _erased(self, folder: JobFolder, now: datetime) -> bool:
        access, job_id = self._access, folder.job_id
        try:
            request, outcome = folder.request(), folder.outcome()
        except JobGone:
            access.records.forget(job_id)
            return False
        except ValueError:  # nobody had read it since it ended
            if access.store.set_aside([job_id]):
                access.records.forget(job_id)
            return False
        except (OSError, StoreUnavailable) as error:
            log.warning("job %s has expired and cannot be read: %s", job_id, error)
            return False
        expiry = expires_at(request, outcome)
        if outcome is None or expiry is None or expiry > now:
            access.records.forget(job_id)
            access.records.restore(request, outcome)
            return False
        self._note(AuditOutcome.DONE, job_id, request.owner, outcome.finished_at, expiry)
        access.erased.remember(job_id, request.owner)
        try:
            ending.erase(folder, access.records)
        except (OSError, StoreUnavailable):
            log.exception("job %s has expired and cannot be erased", job_id)
            self._note(AuditOutcome.FAILED, job_id, request.owner, outcome.finished_at, expiry)
            return False
        access.tallies.count_expired()
        return True

    def _note(
        self, outcome: AuditOutcome, job_id: str, owner: str, ended_at: datetime, expiry: datetime
    ) -> None:
        entry = AuditEntry(
            at=datetime.now(tz=UTC),
            actor=ACTOR,
            owner=owner,
            action=Action.ERASE,
            outcome=outcome,
            job=job_id,
            ended_at=ended_at,
            expires_at=expiry,
        )
        try:
            self._audit.write(entry)
        except OSError as error:  # erasing may free the very space that the line needs
            line = entry.model_dump_json(exclude_none=True)
            log.error("the audit log takes no line (%r): %s", error, line)
