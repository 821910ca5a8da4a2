"""The place of an event in its job's stream: a Redis stream id, `<Unix time, ms>-<number>`."""

import re
from typing import NamedTuple

_ID = re.compile(r"([0-9]{1,20})-([0-9]{1,20})")
LARGEST = 2**64 - 1
"""As a number it is in no stream: Redis counts up to it within a millisecond."""


class EventId(NamedTuple):
    """Ids are ordered as their events happened."""

    ms: int
    number: int

    @classmethod
    def of_text(cls, text: str) -> "EventId | None":
        """The id that is written there; None for what is none."""
        match = _ID.fullmatch(text)
        if match is None:
            return None
        id_ = cls(int(match[1]), int(match[2]))
        return id_ if max(id_) <= LARGEST else None

    def __str__(self) -> str:
        return f"{self.ms}-{self.number}"


START = EventId(0, 0)
"""Before every event."""
