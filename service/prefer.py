"""What a request prefers: RFC 7240."""

import re
from typing import Annotated

from fastapi import Header
from pydantic import WithJsonSchema

# A parameter's or preference's value may be quoted, with commas in it.
_PREFERENCE = re.compile(r'(?:[^,"]|"(?:[^"\\]|\\.)*")+')
_WAIT = re.compile(r'\s*wait\s*=\s*("?)([0-9]{1,9})\1\s*(?:;.*)?', re.IGNORECASE | re.DOTALL)

Prefer = Annotated[
    list[str] | None,
    Header(
        alias="Prefer",
        description="`wait=N`: hold the answer until the job has ended, N seconds at most.",
    ),
    # Any text is a list of preferences, and those that are not known are ignored.
    WithJsonSchema({"type": "string", "examples": ["wait=30"]}),
]


_MAX_LENGTH = 1000
"""Longer ones are not looked at: a preference may be ignored, and quotes take time to match."""


def preferred_wait_s(prefer: list[str]) -> int | None:
    """The seconds of the first `wait` preference; None where there is none that can be read."""
    for preference in _PREFERENCE.findall(",".join(prefer)[:_MAX_LENGTH]):
        match = _WAIT.fullmatch(preference)
        if match is not None:
            return int(match[2])
    return None
