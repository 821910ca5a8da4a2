"""Work in parts that do not need each other, and whoever does them: one hand, or many.

Results are the same whoever did which part, and in the order of the parts.
"""

from collections.abc import Callable, Sequence
from dataclasses import dataclass
from typing import Any, Protocol, runtime_checkable

from worker.checkpoints import Checkpoints
from worker.observer import Observer
from worker.progress_share import ProgressShare


@dataclass(frozen=True, eq=False)
class Part:
    """`function(*arguments, observer, checkpoints)`, which raises Cancelled, or returns what it has
    by then, within a second of the observer's asking to stop.

    function: of a module, for it goes to another process by name, its arguments and its result by
    value. cost: beside that of the other parts.
    """

    function: Callable[..., Any]
    arguments: tuple[Any, ...]
    cost: float = 1.0

    def done(self, observer: Observer, checkpoints: Checkpoints) -> Any:
        """Its result."""
        return self.function(*self.arguments, observer, checkpoints)


@runtime_checkable
class Crew(Protocol):
    """Who does the parts."""

    def all_of(
        self, parts: Sequence[Part], observer: Observer, checkpoints: Checkpoints
    ) -> list[Any]:
        """The results. Raises what a part raises."""


class Alone:
    """This process does one part after another."""

    def all_of(
        self, parts: Sequence[Part], observer: Observer, checkpoints: Checkpoints
    ) -> list[Any]:
        whole = sum(part.cost for part in parts)
        results, done = [], 0.0
        for part in parts:
            share = ProgressShare(observer, done / whole, (done + part.cost) / whole)
            results.append(part.done(share, checkpoints))
            done += part.cost
        return results
