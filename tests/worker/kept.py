"""Checkpoints in memory, with all that was ever saved."""

from collections import defaultdict


class Kept:
    """Gives what was saved last; `saved` has everything, in order, by key."""

    def __init__(self, held: dict[str, bytes] | None = None) -> None:
        self.held = dict(held or {})
        self.saved: dict[str, list[bytes]] = defaultdict(list)

    def load(self, key: str) -> bytes | None:
        return self.held.get(key)

    def save(self, key: str, content: bytes) -> None:
        self.held[key] = content
        self.saved[key].append(content)
