"""The Redis client of this project: text replies, and never a wait without an end."""

from redis import Redis
from redis.asyncio import Redis as AsyncRedis
from redis.asyncio.retry import Retry as AsyncRetry
from redis.backoff import ConstantBackoff
from redis.exceptions import ConnectionError as RedisConnectionError
from redis.retry import Retry


def make_redis(url: str, timeout_s: float = 2.0) -> Redis:
    """A client that gives up on any one command after `timeout_s` (twice that to connect anew).

    A broken connection is tried once more, so that a restarted Redis costs no request; a timeout is
    not, since whoever waits for us waits twice then, and the command may have been carried out.
    """
    return Redis.from_url(
        url,
        decode_responses=True,
        socket_timeout=timeout_s,
        socket_connect_timeout=timeout_s,
        socket_keepalive=True,
        health_check_interval=15,
        retry=Retry(ConstantBackoff(0.05), 1, supported_errors=(RedisConnectionError,)),
    )


def make_async_redis(url: str, timeout_s: float = 2.0) -> AsyncRedis:
    """The same for an event loop. To be closed by who made it."""
    return AsyncRedis.from_url(
        url,
        decode_responses=True,
        socket_timeout=timeout_s,
        socket_connect_timeout=timeout_s,
        socket_keepalive=True,
        health_check_interval=15,
        retry=AsyncRetry(ConstantBackoff(0.05), 1, supported_errors=(RedisConnectionError,)),
    )
