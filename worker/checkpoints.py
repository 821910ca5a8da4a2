"""Where a long computation leaves what it has found so far, without knowing where that is kept.

What is kept under a key may be gone, or may never have been kept: then the work is done anew, and
comes out the same.
"""

from dataclasses import dataclass, field
from typing import Protocol, runtime_checkable


@runtime_checkable
class Checkpoints(Protocol):
    """Bytes by key, of this computation alone: same input, options, code and machine."""

    def load(self, key: str) -> bytes | None:
        """What was saved last; None where nothing sound is there."""

    def save(self, key: str, content: bytes) -> None:
        """Keep it in place of what was there, if that can be done."""


class Unkept:
    """Nothing is kept."""

    def load(self, key: str) -> bytes | None:
        return None

    def save(self, key: str, content: bytes) -> None:
        """Nobody keeps it."""


@dataclass(frozen=True)
class Checkpoint:
    """The place of one part of the work among all checkpoints."""

    kept_in: Checkpoints = field(default_factory=Unkept)
    key: str = "all"

    def of(self, part: str) -> "Checkpoint":
        """The place of a part of this part."""
        return Checkpoint(self.kept_in, f"{self.key}-{part}")

    def load(self) -> bytes | None:
        return self.kept_in.load(self.key)

    def save(self, content: bytes) -> None:
        self.kept_in.save(self.key, content)
