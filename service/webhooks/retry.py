"""When to try again."""

from datetime import UTC, datetime
from email.utils import parsedate_to_datetime

_MOST_S = 86400.0
"""No receiver may put us off for longer at once."""

_JITTER = 0.1


def wait_s(delay_s: float, put_off_s: float, draw: float) -> float:
    """Seconds until the next attempt.

    The schedule's delay, a tenth more or less by `draw` in [0, 1) so that what failed together does
    not come back together; or what the receiver asked for, where that is longer.
    """
    return max(delay_s * (1.0 + _JITTER * (2.0 * draw - 1.0)), min(put_off_s, _MOST_S))


def retry_after_s(header: str | None, now: datetime) -> float:
    """`Retry-After` in seconds or as a date (RFC 9110, 10.2.3); 0 without one that can be read."""
    if header is None:
        return 0.0
    if header.strip().isdecimal():
        return float(header)
    try:
        until = parsedate_to_datetime(header)
    except ValueError:
        return 0.0
    if until.tzinfo is None:  # "-0000": the time is UTC, the place unknown
        until = until.replace(tzinfo=UTC)
    return max(0.0, (until - now).total_seconds())
