"""Which job was made under which `Idempotency-Key`, looked up in Redis.

The keys themselves are in the jobs' folders. The index is written and removed with the job's
record, in the same transaction, so it is whole whenever the records are; `are_whole` says whether
they are, since a key that Redis has lost must not be taken for a new one.
"""

import hashlib
import secrets
from typing import cast

from redis import Redis
from redis.client import Pipeline

from jobs.record import Record
from schemas.messages import Idempotency

_WHOLE_KEY = "neuralmri:records-are-whole"
_ROUND_EXPIRES_S = 3600

_END_ROUND = """
if redis.call('GET', KEYS[1]) ~= ARGV[1] then return 0 end
redis.call('DEL', KEYS[1])
redis.call('SET', KEYS[2], ARGV[1])
return 1
"""


def entry_key(owner: str, idempotency: Idempotency) -> str:
    """Where the index has a key of one owner."""
    digest = hashlib.sha256(idempotency.key.encode()).hexdigest()
    return f"neuralmri:idempotency:{owner}:{digest}"


def entry(job_id: str, idempotency: Idempotency) -> str:
    """What stands there: the job, and the hash of its payload."""
    return f"{job_id}:{idempotency.payload_sha256}"


def move_key(pipe: Pipeline, before: Record | None, after: Record | None) -> None:
    """Queue the commands that list the key of a new record, or drop that of a forgotten one."""
    if before is None and after is not None and after.idempotency is not None:
        pipe.set(entry_key(after.owner, after.idempotency), entry(after.job_id, after.idempotency))
    if after is None and before is not None and before.idempotency is not None:
        pipe.delete(entry_key(before.owner, before.idempotency))


class Wholeness:
    """Whether every job with a folder has had a record since Redis last lost anything.

    A Redis that was emptied has lost the mark, one that was restarted has another run id: it may
    have lost its last second. Every method raises RedisError.
    """

    def __init__(self, redis: Redis) -> None:
        self._redis = redis

    def is_certain(self) -> bool:
        return self._redis.get(_WHOLE_KEY) == self._run_id()

    def begin_round(self) -> tuple[str, str]:
        """Before every folder is looked at. Give what this returns to `end_round`."""
        round_key, run_id = f"neuralmri:round:{secrets.token_hex(8)}", self._run_id()
        self._redis.set(round_key, run_id, ex=_ROUND_EXPIRES_S)
        return round_key, run_id

    def end_round(self, begun: tuple[str, str]) -> None:
        """After it: records are whole, unless Redis was emptied or restarted meanwhile."""
        round_key, run_id = begun
        self._redis.eval(_END_ROUND, 2, round_key, _WHOLE_KEY, run_id)

    def _run_id(self) -> str:
        return cast(str, self._redis.info("server")["run_id"])
