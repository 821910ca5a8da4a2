"""The background thread that makes Redis agree with the folders."""

import logging
import threading
from types import TracebackType

from redis.exceptions import RedisError

from jobs.reconcile import reconcile
from schemas.problem import InternalError
from service.access import JobAccess

log = logging.getLogger("neuralmri.reconciler")

_SOONER_S = 5.0


class Reconciler:
    """Reconciles at once and every `reconcile_every_s`; sooner after a round that failed."""

    def __init__(self, access: JobAccess) -> None:
        self._access = access
        self._stopping = threading.Event()
        self._thread = threading.Thread(target=self._run, name="reconciler", daemon=True)

    def __enter__(self) -> "Reconciler":
        self._thread.start()
        return self

    def __exit__(
        self,
        kind: type[BaseException] | None,
        error: BaseException | None,
        trace: TracebackType | None,
    ) -> None:
        self._stopping.set()
        self._thread.join(timeout=10.0)

    def _run(self) -> None:
        every_s = self._access.settings.reconcile_every_s
        while not self._stopping.is_set():
            self._stopping.wait(every_s if self._round() else min(every_s, _SOONER_S))

    def _round(self) -> bool:
        access = self._access
        try:
            mended = reconcile(
                access.store, access.records, access.queue, access.settings.lost_after_s
            )
            access.queue.give_batch_turn(access.settings.batch_turn_s)
        except (RedisError, InternalError) as error:
            log.warning("not reconciled: %s", error)
            return False
        except Exception:
            # Whatever it was, jobs that are lost later still need this thread.
            log.exception("not reconciled")
            return False
        if mended.is_something:
            log.info("reconciled: %s", mended)
        return True
