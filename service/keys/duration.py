"""Spans of time as a person writes them: `90d`, `12h`, `30m`, `0s`."""

import re
from datetime import timedelta

from schemas.problem import InputError, ProblemType

_UNITS_S = {"s": 1, "m": 60, "h": 3600, "d": 86_400}
_LONGEST = timedelta(days=3650)


def duration(text: str) -> timedelta:
    """What the text means. Raises InputError for anything else, and for more than ten years."""
    found = re.fullmatch(r"([0-9]{1,9})([smhd])", text.strip())
    span = timedelta(seconds=int(found[1]) * _UNITS_S[found[2]]) if found else None
    if span is None or span > _LONGEST:
        raise InputError(
            ProblemType.INVALID_REQUEST,
            f"{text!r} is no span of time. Remedy: give a whole number and one of s, m, h, d, up "
            "to 3650d: 90d, say",
        )
    return span
