"""A Redis that somebody else runs: asked before anything is started that needs it."""

import time
from urllib.parse import urlsplit

from redis.exceptions import RedisError

from jobs.redis_client import make_redis
from schemas.problem import InputError, InternalError, ProblemType

_LOOK_EVERY_S = 0.1


def wait_for_redis(url: str, within_s: float) -> None:
    """Return once the Redis at `url` answers.

    Raises InputError for what is no such URL, InternalError where it does not answer in time; no
    message holds the password.
    """
    deadline = time.monotonic() + within_s
    try:
        client = make_redis(url)
    except ValueError as error:
        raise InputError(
            ProblemType.INVALID_REQUEST,
            f"--redis-url is no URL of a Redis ({error}); write redis://HOST:PORT/0, or rediss:// "
            "for TLS",
        ) from error
    with client:
        while True:
            try:
                client.ping()
                return
            except RedisError as error:
                if time.monotonic() > deadline:
                    raise InternalError(
                        ProblemType.UNAVAILABLE,
                        f"Redis does not answer at {_place(url)} within {within_s:g} s "
                        f"({type(error).__name__}); start it, mend --redis-url, or leave that out "
                        "for a private one",
                    ) from error
            time.sleep(_LOOK_EVERY_S)


def _place(url: str) -> str:
    """Host and port as they are written, without user and password."""
    return urlsplit(url).netloc.rpartition("@")[2]
