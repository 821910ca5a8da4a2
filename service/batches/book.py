"""The records of batches, read and written; and whose turn it is to change one."""

import logging
import time
from collections.abc import Iterator
from contextlib import contextmanager

from pydantic import ValidationError
from redis import Redis
from redis.exceptions import RedisError

from jobs.batch_store import BatchStore, is_batch_id
from schemas.batch import BatchRecord
from schemas.problem import InputError, ProblemType
from service.webhooks.dispatch_lock import DispatchLock

_HOLD_S = 30.0
"""From one study to the next of a batch that is being taken in; each takes less, by far."""
_PATIENCE_S = 2.0
_LOOK_EVERY_S = 0.05
_REMEMBERED = 100_000

Turn = DispatchLock

_LOGGER = logging.getLogger("neuralmri.batches")


class BatchBook:
    """Records by the ids of their batches. Any thread may ask."""

    def __init__(self, store: BatchStore, redis: Redis) -> None:
        self._store = store
        self._redis = redis
        self._owners: dict[str, str] = {}

    def ids(self) -> list[str]:
        """Of every batch, oldest first."""
        return self._store.ids()

    def read(self, batch_id: str) -> BatchRecord | None:
        """The record; None for an unknown id, malformed ones included, and for one not readable."""
        content = self._store.read(batch_id) if is_batch_id(batch_id) else None
        if content is None:
            return None
        try:
            return BatchRecord.model_validate_json(content)
        except ValidationError as error:
            _LOGGER.error("the record of batch %s cannot be read: %s", batch_id, error)
            return None

    def owner(self, batch_id: str) -> str | None:
        """Whose batch it is, which never changes; None for one that is not there."""
        owner = self._owners.get(batch_id)
        if owner is None and (record := self.read(batch_id)):
            owner = record.owner
            if len(self._owners) >= _REMEMBERED:
                self._owners.clear()
            self._owners[batch_id] = owner
        return owner

    def with_tail(self, tail: str) -> BatchRecord | None:
        """The batch whose id ends so, of which there is one at most."""
        found = [batch_id for batch_id in self.ids() if batch_id.endswith(tail)]
        return self.read(found[0]) if found else None

    def write(self, record: BatchRecord) -> None:
        self._store.write(record.batch_id, record.model_dump_json().encode())

    def erase(self, batch_id: str) -> None:
        self._store.erase(batch_id)

    @contextmanager
    def turn(self, tail: str, *, patience_s: float = _PATIENCE_S) -> Iterator[Turn]:
        """Alone at the batch whose id ends so; hold the turn again before each step.

        Raises InputError (idempotency key pending, 409) where another is at it still, and
        RedisError.
        """
        turn = DispatchLock(self._redis, _HOLD_S, f"neuralmri:batch-lock:{tail}")
        patient_until_s = time.monotonic() + patience_s
        while not turn.hold():
            if time.monotonic() >= patient_until_s:
                raise still_taken_in()
            time.sleep(_LOOK_EVERY_S)
        try:
            yield turn
        finally:
            try:
                turn.release()
            except RedisError as error:
                _LOGGER.warning("the turn at a batch was not given back, it runs out: %s", error)


def still_taken_in() -> InputError:
    """The refusal of who finds another at the batch."""
    return InputError(
        ProblemType.IDEMPOTENCY_KEY_PENDING,
        "the batch is still being taken in. Remedy: send the request again after Retry-After.",
        status=409,
        retry_after_s=1,
    )
