"""Asking a server again that did not answer, or said that it cannot now.

A lost connection says nothing about a job; neither does a server that is restarted or overrun.
"""

import random
import time
from collections.abc import Callable
from datetime import UTC, datetime
from email.utils import parsedate_to_datetime
from typing import TypeVar

import httpx

from schemas.problem import ServiceError

T = TypeVar("T")

PASSING = (429, 502, 503, 504)
"""Statuses of a server, or of a proxy before it, that may be another one in a while."""

_FIRST_PAUSE_S = 0.5
_LONGEST_PAUSE_S = 15.0


class TryAgain(Exception):  # noqa: N818 - it reads as what to do, not as an error
    """An attempt that failed for a while.

    error: what to say where trying again does not help either.
    after_s: how long the server wants to be left alone; None where it did not say.
    progressed: whether the attempt came further than the one before.
    """

    def __init__(
        self, error: ServiceError, after_s: float | None = None, *, progressed: bool = False
    ) -> None:
        super().__init__(error.detail)
        self.error = error
        self.after_s = after_s
        self.progressed = progressed


def persistently(attempt: Callable[[], T], within_s: float, tell: Callable[[str], None]) -> T:
    """What `attempt` returns, made again for as long as it raises TryAgain.

    Pauses double, with a random part, so that many clients do not come back at once; never shorter
    than the server asks for. Given up `within_s` after the last progress, or at once where the
    server asks for more than is left; the attempt's error is raised then.

    Args:
        attempt: Safe to be made twice.
        within_s: 0 for a single attempt.
        tell: Told before each pause why there is one.
    """
    deadline_s = time.monotonic() + within_s
    pause_s = _FIRST_PAUSE_S
    while True:
        try:
            return attempt()
        except TryAgain as again:
            if again.progressed:
                deadline_s = time.monotonic() + within_s
                pause_s = _FIRST_PAUSE_S
            wait_s = max(again.after_s or 0.0, pause_s * random.uniform(0.5, 1.0))  # noqa: S311  no secret
            if time.monotonic() + wait_s > deadline_s:
                raise again.error from again
            tell(f"{again.error.detail}; trying again in {wait_s:.0f} s")
        time.sleep(wait_s)
        pause_s = min(2.0 * pause_s, _LONGEST_PAUSE_S)


def retry_after_s(response: httpx.Response) -> float | None:
    """What `Retry-After` asks for, in seconds from now: a number or a date (RFC 9110)."""
    text = response.headers.get("retry-after", "").strip()
    if text.isdecimal():
        return float(text)
    try:
        until = parsedate_to_datetime(text)
    except ValueError:
        return None
    until = until if until.tzinfo else until.replace(tzinfo=UTC)
    return max(0.0, (until - datetime.now(tz=UTC)).total_seconds())
