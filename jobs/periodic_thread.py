"""A thread that does something from time to time, until it is left."""

import threading
from abc import ABC, abstractmethod
from contextvars import copy_context
from types import TracebackType
from typing import Self


class PeriodicThread(ABC):
    """Runs from entering to leaving the `with` block, in the context of whoever made it.

    A subclass says in `_run` what is done, and returns from there once `_pause` says False.
    """

    def __init__(self, name: str, join_within_s: float | None = None) -> None:
        """join_within_s: how long leaving waits for what is under way; None for its end."""
        self._join_within_s = join_within_s
        self._left = threading.Event()
        # What it logs is about the same job as its maker is.
        self._thread = threading.Thread(
            target=copy_context().run, args=(self._run,), name=name, daemon=True
        )

    def __enter__(self) -> Self:
        self._thread.start()
        return self

    def __exit__(
        self,
        kind: type[BaseException] | None,
        error: BaseException | None,
        trace: TracebackType | None,
    ) -> None:
        self._left.set()
        self._thread.join(self._join_within_s)

    @abstractmethod
    def _run(self) -> None:
        """What the thread does."""

    def _pause(self, seconds: float) -> bool:
        """Wait. True: go on. False, and at once: the block was left."""
        return not self._left.wait(seconds)
