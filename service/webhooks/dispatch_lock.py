"""One doer among all service processes, the dispatcher unless another is named: a lock in Redis
that runs out by itself.
"""

import secrets
import time
from typing import Any, cast

from redis import Redis

_KEY = "neuralmri:webhooks:dispatcher"

_HOLD = """
local holder = redis.call('get', KEYS[1])
if holder and holder ~= ARGV[1] then
  -- Longer than it is ever held: the clock went back. Its holder, if it lives, holds on.
  if redis.call('pttl', KEYS[1]) > tonumber(ARGV[2]) then
    redis.call('pexpire', KEYS[1], ARGV[2])
  end
  return 0
end
redis.call('set', KEYS[1], ARGV[1], 'px', ARGV[2])
return 1
"""
_RELEASE = """
if redis.call('get', KEYS[1]) == ARGV[1] then redis.call('del', KEYS[1]) end
return 0
"""


class DispatchLock:
    """Held for `hold_s` from the last `hold`. Where Redis forgets it two may hold it for that long;
    a message may then be sent twice, under one id.
    """

    def __init__(self, redis: Redis, hold_s: float, key: str = _KEY) -> None:
        self._redis = redis
        self._key = key
        self._hold_s = hold_s
        self._name = secrets.token_hex(16)
        self._held_until_s = 0.0

    def hold(self) -> bool:
        """Take the lock, or keep it. False: another has it. Raises RedisError."""
        asked_at_s = time.monotonic()
        held = self._eval(_HOLD, self._name, int(self._hold_s * 1000))
        self._held_until_s = asked_at_s + self._hold_s if held else 0.0
        return bool(held)

    @property
    def is_held(self) -> bool:
        """Whether it is still ours, by our own clock: a process that was stopped finds it lost."""
        return time.monotonic() < self._held_until_s

    def release(self) -> None:
        """Let another have it at once. Raises RedisError."""
        self._held_until_s = 0.0
        self._eval(_RELEASE, self._name)

    def _eval(self, script: str, *arguments: str | int) -> int:
        return cast(int, cast(Any, self._redis).eval(script, 1, self._key, *arguments))
