"""Whether one more job may come in: asked before anything is written, answered atomically.

Whoever is admitted holds a place, and its idempotency key, until the job's record takes over both
in one transaction, or until it withdraws. One that dies in between loses them after a while.
"""

from dataclasses import dataclass
from enum import StrEnum
from typing import cast

from redis import Redis
from redis.client import Pipeline

from jobs.idempotency_keys import entry, entry_key
from jobs.index import ANY_OWNER, index_key, record_key
from jobs.record import Record
from schemas.job import JobState
from schemas.messages import JobRequest

_PLACE_S = 120
"""How long a place is held. Writing a folder takes less, by far; receiving it came before."""

# KEYS: places of all and of the owner; queued jobs of all; the owner's queued, running and
# cancelling; the key's entry. ARGV: job, its entry or '', bound of all, of the owner (-1: none),
# how long a place is held (ms), what record keys begin with.
_ASK = """
local time = redis.call('TIME')
local now_ms = time[1] * 1000 + math.floor(time[2] / 1000)
for i = 1, 2 do
  redis.call('ZREMRANGEBYSCORE', KEYS[i], '-inf', now_ms)
  -- Held longer than any place is: the clock went back.
  local latest_ms = now_ms + ARGV[5]
  for _, job in ipairs(redis.call('ZRANGEBYSCORE', KEYS[i], '(' .. latest_ms, '+inf')) do
    redis.call('ZADD', KEYS[i], latest_ms, job)
  end
  redis.call('ZREM', KEYS[i], ARGV[1]) -- asked for again: the place it had does not count
end
if ARGV[2] ~= '' then
  local held = redis.call('GET', KEYS[7])
  if held then
    local holder = string.sub(held, 1, string.find(held, ':') - 1)
    if redis.call('EXISTS', ARGV[6] .. holder) == 1 then return {'key-known', held} end
    if redis.call('ZSCORE', KEYS[1], holder) then return {'key-pending', held} end
  end
end
if tonumber(ARGV[4]) >= 0 then
  local unfinished = redis.call('ZCARD', KEYS[2])
  for i = 4, 6 do unfinished = unfinished + redis.call('ZCARD', KEYS[i]) end
  if unfinished >= tonumber(ARGV[4]) then return {'too-many-jobs', ''} end
end
if redis.call('ZCARD', KEYS[1]) + redis.call('ZCARD', KEYS[3]) >= tonumber(ARGV[3]) then
  return {'queue-full', ''}
end
for i = 1, 2 do redis.call('ZADD', KEYS[i], now_ms + ARGV[5], ARGV[1]) end
if ARGV[2] ~= '' then redis.call('SET', KEYS[7], ARGV[2], 'PX', ARGV[5]) end
return {'admitted', ''}
"""

# KEYS: places of all and of the owner, the key's entry, the record. ARGV: job, its entry or ''.
_WITHDRAW = """
for i = 1, 2 do redis.call('ZREM', KEYS[i], ARGV[1]) end
if ARGV[2] ~= '' and redis.call('GET', KEYS[3]) == ARGV[2] and redis.call('EXISTS', KEYS[4]) == 0
then redis.call('DEL', KEYS[3]) end
"""


class Verdict(StrEnum):
    """What becomes of a request."""

    ADMITTED = "admitted"
    """A place is held: submit the job, or withdraw."""
    KEY_KNOWN = "key-known"
    """There is a job under this idempotency key."""
    KEY_PENDING = "key-pending"
    """Another request with this key is being written."""
    QUEUE_FULL = "queue-full"
    """As many jobs wait as may."""
    TOO_MANY_JOBS = "too-many-jobs"
    """The owner has as many unfinished jobs as it may."""


@dataclass(frozen=True)
class Answer:
    """The verdict; where the key is taken, by which job and for which payload."""

    verdict: Verdict
    holder: str | None = None
    payload_sha256: str | None = None


class Admission:
    """The bounds. Every method raises RedisError."""

    def __init__(self, redis: Redis, max_queued_jobs: int, max_jobs_per_owner: int | None) -> None:
        self._redis = redis
        self._max_queued_jobs = max_queued_jobs
        self._max_jobs_per_owner = max_jobs_per_owner

    def ask(self, request: JobRequest, owner: str) -> Answer:
        """Ask for a place among the queued jobs, and for the request's idempotency key."""
        places = _places_keys(owner)
        unfinished = (JobState.QUEUED, JobState.RUNNING, JobState.CANCELLING)
        keys = [
            *places,
            index_key(ANY_OWNER, JobState.QUEUED),
            *(index_key(owner, state) for state in unfinished),
            _entry_key(request, owner),
        ]
        per_owner = -1 if self._max_jobs_per_owner is None else self._max_jobs_per_owner
        arguments = [
            request.job_id,
            _entry(request),
            str(self._max_queued_jobs),
            str(per_owner),
            str(_PLACE_S * 1000),
            record_key(""),
        ]
        said = self._redis.eval(_ASK, len(keys), *keys, *arguments)
        verdict, held = cast(list[str], said)
        holder, _, payload = held.partition(":")
        return Answer(Verdict(verdict), holder or None, payload or None)

    def knows(self, request: JobRequest, owner: str) -> bool:
        """Whether some job has the request's idempotency key, or is being given it."""
        return bool(self._redis.exists(_entry_key(request, owner)))

    def withdraw(self, request: JobRequest, owner: str) -> None:
        """Give place and key back: the job did not come about."""
        keys = [*_places_keys(owner), _entry_key(request, owner), record_key(request.job_id)]
        self._redis.eval(_WITHDRAW, len(keys), *keys, request.job_id, _entry(request))


def give_up_place(pipe: Pipeline, before: Record | None, after: Record | None) -> None:
    """Queue the commands by which a new record takes over from the place held for it."""
    if before is None and after is not None:
        for key in _places_keys(after.owner):
            pipe.zrem(key, after.job_id)


def _places_keys(owner: str) -> tuple[str, str]:
    """The sorted sets of places held, by when they expire (ms): everybody's, and the owner's."""
    return "neuralmri:places", f"neuralmri:places:{owner}"


def _entry_key(request: JobRequest, owner: str) -> str:
    return entry_key(owner, request.idempotency) if request.idempotency else "neuralmri:no-key"


def _entry(request: JobRequest) -> str:
    return entry(request.job_id, request.idempotency) if request.idempotency else ""
