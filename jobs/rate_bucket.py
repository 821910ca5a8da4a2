"""Token buckets in Redis, on its clock: so many requests a window, and as many at once.

A bucket is one number, the instant at which it is full again (the generic cell rate algorithm), and
is forgotten then: memory is bounded by those who called within the last window.
"""

from collections.abc import Sequence
from dataclasses import dataclass
from typing import cast

from redis import Redis

# KEYS: buckets. ARGV: quota and window (us) of each. All give a token, or none does.
_TAKE = """
local time = redis.call('TIME')
local now = time[1] * 1000000 + time[2]
local full, wait = {}, 0
for i, key in ipairs(KEYS) do
  local quota, window = tonumber(ARGV[2 * i - 1]), tonumber(ARGV[2 * i])
  full[i] = math.max(tonumber(redis.call('GET', key) or '0'), now)
  wait = math.max(wait, full[i] + window / quota - window - now)
end
local reply = {math.ceil(wait)}
for i, key in ipairs(KEYS) do
  local quota, window = tonumber(ARGV[2 * i - 1]), tonumber(ARGV[2 * i])
  if wait <= 0 then
    full[i] = full[i] + window / quota
    local left_ms = math.ceil((full[i] - now) / 1000)
    redis.call('SET', key, string.format('%.3f', full[i]), 'PX', math.max(left_ms, 1))
  end
  reply[2 * i] = math.floor((window - (full[i] - now)) * quota / window + 0.000001)
  reply[2 * i + 1] = math.ceil(full[i] - now)
end
return reply
"""


@dataclass(frozen=True)
class Policy:
    """name: what clients are told. quota: requests in `window_s`, at least 1."""

    name: str
    quota: int
    window_s: int = 60


@dataclass(frozen=True)
class Bucket:
    """A policy, held against one caller."""

    policy: Policy
    caller: str

    @property
    def key(self) -> str:
        return f"neuralmri:rate:{self.policy.name}:{self.caller}"


@dataclass(frozen=True)
class Level:
    """What a bucket holds after a request: tokens, and the time until it is full, s."""

    policy: Policy
    remaining: int
    full_in_s: float


@dataclass(frozen=True)
class Taken:
    """wait_s: 0 where a token was taken from each bucket; else the time until that may be."""

    wait_s: float
    levels: tuple[Level, ...]


def take(redis: Redis, buckets: Sequence[Bucket]) -> Taken:
    """Take a token from each bucket, or from none. Raises RedisError."""
    arguments = [
        str(number)
        for bucket in buckets
        for number in (bucket.policy.quota, bucket.policy.window_s * 1_000_000)
    ]
    keys = [bucket.key for bucket in buckets]
    wait_us, *levels = cast(list[int], redis.eval(_TAKE, len(keys), *keys, *arguments))
    return Taken(
        wait_us / 1e6 if wait_us > 0 else 0.0,
        tuple(
            Level(bucket.policy, max(0, levels[2 * at]), max(0, levels[2 * at + 1]) / 1e6)
            for at, bucket in enumerate(buckets)
        ),
    )
