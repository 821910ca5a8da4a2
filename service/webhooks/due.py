"""Which messages are to be sent now, without reading all of them each time."""

import os
from dataclasses import dataclass
from datetime import datetime
from pathlib import Path

from service.webhooks.outbox import Outbox


@dataclass(frozen=True)
class _Seen:
    """What a file held when it was last read; `version` is another once it is replaced."""

    version: tuple[int, int]
    next_at: datetime | None


class DueMessages:
    """An index over an outbox that reads a message again only when its file has been replaced."""

    def __init__(self, outbox: Outbox, kept: int) -> None:
        self._outbox = outbox
        self._kept = kept
        self._seen: dict[str, dict[str, _Seen]] = {}

    def of(self, endpoint_id: str, now: datetime) -> list[str]:
        """Ids of an endpoint's messages whose time has come, the most overdue first.

        Of those that have ended, all but the last `kept` are removed on the way.
        """
        seen = self._look(endpoint_id)
        ended = sorted(
            (seen_.version[0], message_id)
            for message_id, seen_ in seen.items()
            if seen_.next_at is None
        )
        for _, message_id in ended[: -self._kept]:
            self._outbox.drop(endpoint_id, message_id)
        due = [(s.next_at, message_id) for message_id, s in seen.items() if s.next_at is not None]
        return [message_id for next_at, message_id in sorted(due) if next_at <= now]

    def _look(self, endpoint_id: str) -> dict[str, _Seen]:
        before = self._seen.get(endpoint_id, {})
        after: dict[str, _Seen] = {}
        for entry in self._outbox.entries(endpoint_id):
            message_id = Path(entry.name).stem
            try:
                version = _version(entry)
            except FileNotFoundError:
                continue
            known = before.get(message_id)
            if known is not None and known.version == version:
                after[message_id] = known
            elif message := self._outbox.get(endpoint_id, message_id):
                after[message_id] = _Seen(version, message.next_attempt_at)
        self._seen[endpoint_id] = after
        return after


def _version(entry: "os.DirEntry[str]") -> tuple[int, int]:
    stat = entry.stat(follow_symlinks=False)
    return stat.st_mtime_ns, stat.st_ino
