"""Batches that were left half taken in, because the process that took them in died."""

import logging

from schemas.batch import BatchRecord
from schemas.problem import ServiceError
from service.access import JobAccess
from service.batches.taking_in import take_in

_LOGGER = logging.getLogger("neuralmri.batches")


class UnfinishedBatches:
    """Looks for them. It remembers those it need not look at again, to save time only."""

    def __init__(self, access: JobAccess) -> None:
        self._access = access
        self._settled: set[str] = set()

    def take_in(self) -> None:
        """Go on with every batch of which studies are pending and which nobody is at.

        Its caller was never answered, so nothing is refused for want of room: that waits for the
        next time. Raises RedisError.
        """
        known = set(self._access.batches.ids())
        self._settled &= known
        for batch_id in sorted(known - self._settled):
            record = self._access.batches.read(batch_id)
            if record is None or not record.pending or not self._go_on(record).pending:
                self._settled.add(batch_id)

    def _go_on(self, record: BatchRecord) -> BatchRecord:
        batches = self._access.batches
        try:
            with batches.turn(tail_of(record), patience_s=0.0) as turn:
                found = batches.read(record.batch_id) or record.after({}, [])
                after = take_in(self._access, found, turn, until_room=True)
        except ServiceError as error:
            _LOGGER.info("batch %s is not taken in yet: %s", record.batch_id, error)
            return record
        except OSError:
            # The disk's trouble with one batch is no reason to leave the others.
            _LOGGER.exception("batch %s is not taken in yet", record.batch_id)
            return record
        if found.pending and not after.pending:
            _LOGGER.info("batch %s was left half done, and is taken in now", record.batch_id)
        return after


def tail_of(record: BatchRecord) -> str:
    """By what the turn at a batch is known."""
    return record.batch_id[-20:]
