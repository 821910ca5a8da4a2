"""The messages of each endpoint, on disk: <root>/<endpoint id>/deliveries/<message id>.json.

A message is there from before its first attempt until long after its last. An endpoint that is
removed takes its messages along, and no step brings them back.
"""

import os
import re
from collections.abc import Callable
from pathlib import Path

from service.webhooks.message import MESSAGE_ID_PATTERN, Message
from service.webhooks.private_file import create_private, locked, replace_private

_ID = re.compile(MESSAGE_ID_PATTERN)


class Outbox:
    """The messages below `root`, the folder of endpoints. Endpoint ids must be of known ones."""

    def __init__(self, root: Path) -> None:
        self.root = root

    def add(self, endpoint_id: str, message: Message) -> bool:
        """Store a message, once: False where one of its id is there, or the endpoint is gone."""
        try:
            return create_private(
                self._path(endpoint_id, message.id), message.model_dump_json().encode()
            )
        except FileNotFoundError:
            return False

    def get(self, endpoint_id: str, message_id: str) -> Message | None:
        """The message; None for an unknown id, malformed ones included."""
        if not _ID.fullmatch(message_id):
            return None
        try:
            return Message.model_validate_json(self._path(endpoint_id, message_id).read_bytes())
        except FileNotFoundError:
            return None

    def newest(self, endpoint_id: str, limit: int) -> list[Message]:
        """Up to `limit` messages, the last made first."""
        found = [
            message
            for entry in self.entries(endpoint_id)
            if (message := self.get(endpoint_id, Path(entry.name).stem))
        ]
        return sorted(found, key=lambda m: (m.created_at, m.id), reverse=True)[:limit]

    def entries(self, endpoint_id: str) -> list["os.DirEntry[str]"]:
        """The files of an endpoint's messages; none where it is gone."""
        try:
            found = os.scandir(self.root / endpoint_id / "deliveries")
        except FileNotFoundError:
            return []
        with found:
            return [entry for entry in found if _ID.fullmatch(Path(entry.name).stem)]

    def change(
        self, endpoint_id: str, message_id: str, step: Callable[[Message], Message]
    ) -> Message | None:
        """Take a step and return what the message is then; None for one that is gone."""
        with locked(self.root):
            before = self.get(endpoint_id, message_id)
            if before is None:
                return None
            after = step(before)
            replace_private(self._path(endpoint_id, message_id), after.model_dump_json().encode())
            return after

    def drop(self, endpoint_id: str, message_id: str) -> None:
        self._path(endpoint_id, message_id).unlink(missing_ok=True)

    def _path(self, endpoint_id: str, message_id: str) -> Path:
        return self.root / endpoint_id / "deliveries" / f"{message_id}.json"
