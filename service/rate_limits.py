"""How often a caller may call: by key, or by address where no keys are asked for."""

import hashlib
import logging
import math
import threading
import time
from ipaddress import IPv6Address, ip_address, ip_network

from fastapi import Request
from redis import Redis
from redis.exceptions import RedisError

from jobs.rate_bucket import Bucket, Policy, Taken, take
from jobs.redis_client import make_redis
from schemas.problem import InputError, ProblemType
from service.keys.caller import Caller
from service.settings import ServiceSettings

log = logging.getLogger("neuralmri.service")

_UNCOUNTED = ("/metrics",)
"""What monitoring asks; of the paths that ask for no key, none comes here."""

_SUBMITTING = (
    "/v1/jobs/contours",
    "/v1/jobs/labels",
    "/v1/jobs/files",
    "/v1/jobs/{job_id}/restart",
    "/v1/batches/contours",
)

_TIMEOUT_S = 0.5
_NOT_ASKED_S = 5.0
"""How long Redis is let be after it failed: requests that do without it should not wait for it."""


class RateLimits:
    """Where Redis does not answer, nobody is refused: what needs Redis will say so itself."""

    def __init__(self, settings: ServiceSettings) -> None:
        self._redis: Redis = make_redis(
            settings.redis_url, min(_TIMEOUT_S, settings.redis_timeout_s)
        )
        self._calls = _policy("calls", settings.calls_per_minute)
        self._submits = _policy("submits", settings.submits_per_minute)
        self._refusals = _policy("refusals", settings.refusals_per_minute)
        self._turn = threading.Lock()
        self._let_be_until_s = 0.0

    def admit(self, request: Request, caller: Caller) -> None:
        """Count a request of a caller who is let in. Raises InputError (rate limited, 429)."""
        route: str = request.scope["route"].path
        if route in _UNCOUNTED:
            return
        counted = [self._calls]
        if route in _SUBMITTING and request.method == "POST":
            counted.append(self._submits)
        who = caller.actor if caller.is_named else _address(request)
        self._take(request, [Bucket(policy, who) for policy in counted if policy])

    def refuse(self, request: Request) -> None:
        """Count a request without a good key against its address. Raises InputError (429).

        A good key is let in from any address, however many bad ones came from there: behind one
        address there may be a whole hospital, and no number of guesses finds 256 random bits.
        """
        if self._refusals:
            self._take(request, [Bucket(self._refusals, _address(request))])

    def _take(self, request: Request, buckets: list[Bucket]) -> None:
        if not buckets:
            return
        with self._turn:  # one connection: a count takes a fraction of a millisecond
            if time.monotonic() < self._let_be_until_s:
                return
            try:
                taken = take(self._redis, buckets)
            except RedisError as error:
                self._let_be_until_s = time.monotonic() + _NOT_ASKED_S
                log.warning("requests are not counted for %g s: %s", _NOT_ASKED_S, error)
                return
        request.state.rate = taken
        if taken.wait_s > 0.0:
            raise rate_limited(taken)


def rate_limited(taken: Taken) -> InputError:
    """The refusal, naming the policy that has the least left."""
    policy = min(taken.levels, key=lambda level: level.remaining).policy
    wait_s = math.ceil(taken.wait_s)
    return InputError(
        ProblemType.RATE_LIMITED,
        f"more than {policy.quota} {policy.name} within {policy.window_s} s. Remedy: wait for "
        "Retry-After, and go slower: the headers RateLimit-Policy and RateLimit say how fast; "
        "follow a job by its events, or by Prefer: wait, instead of polling.",
        status=429,
        retry_after_s=max(1, wait_s),
    )


def _policy(name: str, per_minute: int) -> Policy | None:
    return Policy(name, per_minute) if per_minute else None


def _address(request: Request) -> str:
    """The caller's address, as a hash; of IPv6 the network, of which a host has all addresses."""
    host = request.client.host if request.client else ""
    try:
        address = ip_address(host)
    except ValueError:  # a socket file has none
        return "nowhere"
    if isinstance(address, IPv6Address):
        host = str(ip_network((address, 64), strict=False))
    return hashlib.sha256(host.encode()).hexdigest()[:32]
