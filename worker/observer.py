"""How a long computation is watched and stopped, without knowing by whom."""

from collections.abc import Callable
from dataclasses import dataclass
from typing import Protocol, runtime_checkable

from schemas.job import Progress


class Cancelled(Exception):  # noqa: N818  not an error: the caller asked for it
    """The observer asked to stop; nothing was produced."""


@runtime_checkable
class Observer(Protocol):
    """Told of progress at least twice a second, asked as often whether to stop."""

    def advanced(self, progress: Progress) -> None:
        """The computation has come this far."""

    def is_cancelled(self) -> bool:
        """Whether the computation should stop; it then raises `Cancelled` within a second."""


class Unobserved:
    """Nobody watches and nobody stops it."""

    def advanced(self, progress: Progress) -> None:
        """Nobody listens."""

    def is_cancelled(self) -> bool:
        return False


KeepsFound = Callable[[], bool]
"""Asked of whoever stopped a computation: are what it had found by then, and the time that it takes
to finish that, wanted? From a yes on the observer does not ask to stop for the same reason.
"""


@dataclass(frozen=True)
class Finishing:
    """Asks to stop only where what was found by then is not wanted either."""

    observer: Observer
    keeps_found: KeepsFound

    def advanced(self, progress: Progress) -> None:
        self.observer.advanced(progress)

    def is_cancelled(self) -> bool:
        return self.observer.is_cancelled() and not self.keeps_found()


def nothing_kept() -> bool:
    """What is stopped leaves nothing."""
    return False
