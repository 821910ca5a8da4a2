"""How a long computation is watched and stopped, without knowing by whom."""

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
