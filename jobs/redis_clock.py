"""The clock of Redis: one for every host, so that hosts with wrong clocks agree."""

from redis import Redis
from redis.client import Pipeline


def now_us(redis: Redis | Pipeline) -> int:
    """Unix time by the Redis server, microseconds. Raises RedisError."""
    seconds, microseconds = redis.time()
    return seconds * 1_000_000 + microseconds
