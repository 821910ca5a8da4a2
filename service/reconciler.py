"""The background thread that makes Redis agree with the folders, and erases expired jobs."""

import logging

from redis.exceptions import RedisError

from jobs.periodic_thread import PeriodicThread
from jobs.reconcile import reconcile
from jobs.settled import Settled
from schemas.problem import InternalError
from service.access import JobAccess
from service.audit_log import AuditLog
from service.batches.forgetting import ForgottenBatches
from service.batches.unfinished import UnfinishedBatches
from service.retention import Retention

log = logging.getLogger("neuralmri.reconciler")

_SOONER_S = 5.0


class Reconciler(PeriodicThread):
    """Reconciles at once and every `reconcile_every_s`; sooner after a round that failed."""

    def __init__(self, access: JobAccess) -> None:
        super().__init__("reconciler", join_within_s=10.0)
        self._access = access
        self._batches = UnfinishedBatches(access)
        self._forgotten_batches = ForgottenBatches(access)
        self._retention = Retention(access, AuditLog.of_settings(access.settings))
        self._settled = Settled()

    def _run(self) -> None:
        every_s, wait_s = self._access.settings.reconcile_every_s, 0.0
        while self._pause(wait_s):
            wait_s = every_s if self._round() else min(every_s, _SOONER_S)

    def _round(self) -> bool:
        access = self._access
        try:
            mended = reconcile(
                access.store,
                access.records,
                access.queue,
                access.settings.lost_after_s,
                self._settled,
            )
            access.queue.give_batch_turn(access.settings.batch_turn_s)
            self._batches.take_in()
            erased = self._retention.erase_expired()
            self._forgotten_batches.erase_empty()
        except (RedisError, InternalError) as error:
            log.warning("not reconciled: %s", error)
            return False
        except Exception:
            # Whatever it was, jobs that are lost later still need this thread.
            log.exception("not reconciled")
            return False
        if mended.is_something:
            log.info("reconciled: %s", mended)
        if erased:
            log.info("erased %d jobs that had expired", erased)
        return True
