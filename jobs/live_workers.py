"""The workers that are alive, by their heartbeats in Redis, and when one last came through."""

from typing import cast

from redis import Redis

from jobs.redis_clock import now_us

_KEY = "neuralmri:workers"
_SLOTS_KEY = "neuralmri:worker-slots"
_CODE_KEY = "neuralmri:worker-code"
_FINISHED_KEY = "neuralmri:heartbeat"

_PROBE_KEY = "neuralmri:probe"

_FORGOTTEN_AFTER_S = 3600.0
"""Names of workers that are gone would pile up: each start of a container brings a new one."""


_AHEAD_S = 2.0
"""How far ahead of a clock that was just read a sign of life may lie. What lies further ahead was
given before the clock of Redis went back, and says nothing of now."""


class LiveWorkers:
    """Names of workers with their last sign of life. Every method raises RedisError."""

    def __init__(self, redis: Redis) -> None:
        self._redis = redis

    def check_heard(self) -> None:
        """Raises RedisError where Redis would not take a heartbeat: out of memory, or a replica."""
        self._redis.set(_PROBE_KEY, "1", px=1000)

    def heartbeat(self, worker_name: str, slots: int = 1, code_version: str = "") -> None:
        """Say that a worker is alive and takes jobs, `slots` of them at a time, by which code."""
        with self._redis.pipeline() as pipe:
            pipe.zadd(_KEY, {worker_name: now_us(self._redis) / 1e6})
            pipe.hset(_SLOTS_KEY, worker_name, str(slots))
            pipe.hset(_CODE_KEY, worker_name, code_version)
            pipe.execute()

    def names(self, within_s: float) -> list[str]:
        """The workers whose last heartbeat is no older than `within_s`."""
        now_s = now_us(self._redis) / 1e6
        oldest = now_s - within_s
        self._forget_before(oldest - _FORGOTTEN_AFTER_S)
        return sorted(cast(list[str], self._redis.zrangebyscore(_KEY, oldest, now_s + _AHEAD_S)))

    def finished_heartbeat(self) -> None:
        """Say that a worker has taken a heartbeat from the queue and done it."""
        self._redis.set(_FINISHED_KEY, now_us(self._redis))

    def heartbeat_finished_ago_s(self) -> float | None:
        """How long ago a worker last did; None where none has since Redis began, or since its clock
        went back.
        """
        finished_us = cast(str | None, self._redis.get(_FINISHED_KEY))
        if finished_us is None:
            return None
        ago_s = (now_us(self._redis) - int(finished_us)) / 1e6
        return max(0.0, ago_s) if ago_s >= -_AHEAD_S else None

    def slots(self, within_s: float) -> int:
        """How many jobs those workers do at a time, all together."""
        names = self.names(within_s)
        known = self._redis.hmget(_SLOTS_KEY, names) if names else []
        return sum(int(slots or 1) for slots in cast(list[str | None], known))

    def code_versions(self, within_s: float) -> set[str]:
        """By which code those workers do their jobs."""
        names = self.names(within_s)
        known = self._redis.hmget(_CODE_KEY, names) if names else []
        return {version for version in cast(list[str | None], known) if version}

    def _forget_before(self, instant_s: float) -> None:
        gone = cast(list[str], self._redis.zrangebyscore(_KEY, "-inf", instant_s))
        if gone:
            with self._redis.pipeline() as pipe:
                pipe.zrem(_KEY, *gone)
                pipe.hdel(_SLOTS_KEY, *gone)
                pipe.hdel(_CODE_KEY, *gone)
                pipe.execute()
