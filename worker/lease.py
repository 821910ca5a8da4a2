"""The lease on a job, renewed by a thread of its own: a long step of torch does not lose it."""

import logging
import threading
import time

from redis.exceptions import RedisError

from jobs.periodic_thread import PeriodicThread
from jobs.records import JobRecords

_LOGGER = logging.getLogger(__name__)
_RETRY_EVERY_S = 0.5


class Lease(PeriodicThread):
    """Held from entering to leaving the `with` block, unless another attempt takes the job over.

    When Redis does not answer, the job goes on: nobody else can claim it meanwhile either.
    """

    def __init__(self, records: JobRecords, job_id: str, token: int, lease_s: float) -> None:
        super().__init__(f"lease-{job_id}")
        self.job_id = job_id
        self.token = token
        self._records = records
        self._lease_s = lease_s
        self._lost = threading.Event()

    @property
    def is_lost(self) -> bool:
        """Whether the job is no longer ours; once true, always true."""
        return self._lost.is_set()

    def lose(self) -> None:
        """Somebody else has learned that the token is stale."""
        self._lost.set()

    def confirm(self) -> bool:
        """Ask Redis whether the job is still ours, for as long as a lease lasts.

        To be asked before anything is written that others will see. False also when Redis does not
        answer: then the job is done again later, rather than ended twice.
        """
        deadline = time.monotonic() + self._lease_s
        while not self.is_lost:
            try:
                self._renew()
            except RedisError as error:
                if time.monotonic() > deadline:
                    _LOGGER.warning(
                        "job %s: Redis does not answer, giving up: %s", self.job_id, error
                    )
                    return False
                time.sleep(_RETRY_EVERY_S)
            else:
                break
        return not self.is_lost

    def _run(self) -> None:
        while not self.is_lost and self._pause(self._lease_s / 3):
            try:
                self._renew()
            except RedisError as error:
                _LOGGER.warning("job %s: the lease was not renewed: %s", self.job_id, error)

    def _renew(self) -> None:
        if not self._records.renew(self.job_id, self.token, self._lease_s):
            self._lost.set()
