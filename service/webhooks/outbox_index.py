"""What waits in an outbox and what has ended, without reading all of it each time."""

import os
from dataclasses import dataclass
from datetime import datetime
from pathlib import Path

from service.webhooks.outbox import Outbox


@dataclass(frozen=True)
class Seen:
    """What a file held when it was last read; `version` is another once it is replaced.

    next_at: when the message is to be sent; None where it has ended.
    """

    version: tuple[int, int]
    created_at: datetime
    next_at: datetime | None


class OutboxIndex:
    """Reads a message again only when its file has been replaced. For one thread at a time."""

    def __init__(self, outbox: Outbox) -> None:
        self._outbox = outbox
        self._seen: dict[str, dict[str, Seen]] = {}

    def of(self, endpoint_id: str) -> dict[str, Seen]:
        """An endpoint's messages by their ids."""
        before = self._seen.get(endpoint_id, {})
        after: dict[str, Seen] = {}
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
                after[message_id] = Seen(version, message.created_at, message.next_attempt_at)
        self._seen[endpoint_id] = after
        return after

    def keep(self, endpoint_ids: set[str]) -> None:
        """Forget every other endpoint."""
        self._seen = {id_: seen for id_, seen in self._seen.items() if id_ in endpoint_ids}


def _version(entry: "os.DirEntry[str]") -> tuple[int, int]:
    stat = entry.stat(follow_symlinks=False)
    return stat.st_mtime_ns, stat.st_ino
