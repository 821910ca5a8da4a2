"""Who erased which job, for a while: so that erasing it again is answered as the first time was,
and another's job as one that never was.
"""

import logging
from typing import cast

from redis import Redis
from redis.exceptions import RedisError

_LOGGER = logging.getLogger(__name__)
_REMEMBERED_S = 7 * 24 * 3600


class ErasedJobs:
    """Owners by the ids of erased jobs. Erasing needs no Redis; without it this knows none."""

    def __init__(self, redis: Redis) -> None:
        self._redis = redis

    def remember(self, job_id: str, owner: str) -> None:
        try:
            self._redis.set(_key(job_id), owner, ex=_REMEMBERED_S)
        except RedisError as error:
            _LOGGER.warning("that job %s was erased is not remembered: %s", job_id, error)

    def owner_of(self, job_id: str) -> str | None:
        """Whose job it was; None for one that was not erased of late."""
        try:
            return cast(str | None, self._redis.get(_key(job_id)))
        except RedisError as error:
            _LOGGER.warning("whether job %s was erased is not known: %s", job_id, error)
            return None


def _key(job_id: str) -> str:
    return f"neuralmri:erased:{job_id}"
