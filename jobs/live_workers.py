"""The workers that are alive, by their heartbeats in Redis, and when one last came through."""

from typing import cast

from redis import Redis

from jobs.redis_clock import now_us

_KEY = "neuralmri:workers"
_SLOTS_KEY = "neuralmri:worker-slots"
_FINISHED_KEY = "neuralmri:heartbeat"

_PROBE_KEY = "neuralmri:probe"

_FORGOTTEN_AFTER_S = 3600.0
"""Names of workers that are gone would pile up: each start of a container brings a new one."""


class LiveWorkers:
    """Names of workers with their last sign of life. Every method raises RedisError."""

    def __init__(self, redis: Redis) -> None:
        self._redis = redis

    def check_heard(self) -> None:
        """Raises RedisError where Redis would not take a heartbeat: out of memory, or a replica."""
        self._redis.set(_PROBE_KEY, "1", px=1000)

    def heartbeat(self, worker_name: str, slots: int = 1) -> None:
        """Say that a worker is alive and takes jobs, `slots` of them at a time."""
        with self._redis.pipeline() as pipe:
            pipe.zadd(_KEY, {worker_name: now_us(self._redis) / 1e6})
            pipe.hset(_SLOTS_KEY, worker_name, str(slots))
            pipe.execute()

    def names(self, within_s: float) -> list[str]:
        """The workers whose last heartbeat is no older than `within_s`."""
        oldest = now_us(self._redis) / 1e6 - within_s
        self._forget_before(oldest - _FORGOTTEN_AFTER_S)
        return sorted(cast(list[str], self._redis.zrangebyscore(_KEY, oldest, "+inf")))

    def finished_heartbeat(self) -> None:
        """Say that a worker has taken a heartbeat from the queue and done it."""
        self._redis.set(_FINISHED_KEY, now_us(self._redis))

    def heartbeat_finished_ago_s(self) -> float | None:
        """How long ago a worker last did; None where none has since Redis began."""
        finished_us = cast(str | None, self._redis.get(_FINISHED_KEY))
        return (now_us(self._redis) - int(finished_us)) / 1e6 if finished_us else None

    def slots(self, within_s: float) -> int:
        """How many jobs those workers do at a time, all together."""
        names = self.names(within_s)
        known = self._redis.hmget(_SLOTS_KEY, names) if names else []
        return sum(int(slots or 1) for slots in cast(list[str | None], known))

    def _forget_before(self, instant_s: float) -> None:
        gone = cast(list[str], self._redis.zrangebyscore(_KEY, "-inf", instant_s))
        if gone:
            with self._redis.pipeline() as pipe:
                pipe.zrem(_KEY, *gone)
                pipe.hdel(_SLOTS_KEY, *gone)
                pipe.execute()
