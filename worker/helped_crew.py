"""A crew of this process and helpers of it, each with a part at a time."""

import logging
import time
from collections import deque
from collections.abc import Iterator, Sequence
from contextlib import contextmanager
from typing import Any

from schemas.job import Progress
from worker.checkpoints import Checkpoints
from worker.crew import Alone, Crew, Part
from worker.helper import Advanced, Done, Failed, Helper, HelperLost, Load, Message, Save
from worker.observer import Cancelled, Observer

_LOGGER = logging.getLogger(__name__)
_WAIT_S = 0.05
_STOPS_WITHIN_S = 3.0


@contextmanager
def crew_of(processes: int, threads: int) -> Iterator[Crew]:
    """This process and as many helpers as make `processes`; they end with the context.

    threads: of the arithmetic of each.
    """
    crew = HelpedCrew([Helper(threads) for _ in range(processes - 1)])
    try:
        yield crew if processes > 1 else Alone()
    finally:
        crew.end()


class HelpedCrew:
    """Helpers take the parts in order, and so does this process. While it works on its own part it
    serves them whenever the observer is called: progress and checkpoints go through this process
    alone.
    """

    def __init__(self, helpers: Sequence[Helper]) -> None:
        self.helpers = list(helpers)

    def all_of(
        self, parts: Sequence[Part], observer: Observer, checkpoints: Checkpoints
    ) -> list[Any]:
        work = _Round(self.helpers, parts, observer, checkpoints)
        try:
            return work.results()
        finally:
            # Lost ones, and where a part has failed those that still work on another.
            gone = [*work.lost, *work.busy]
            for helper in gone:
                helper.end()
            self.helpers = [one for one in self.helpers if one not in gone]

    def end(self) -> None:
        """End all helpers."""
        for helper in self.helpers:
            helper.end()
        self.helpers = []


class _Round:
    """All parts of one call. Itself the observer of this process's own part."""

    def __init__(
        self,
        helpers: Sequence[Helper],
        parts: Sequence[Part],
        observer: Observer,
        checkpoints: Checkpoints,
    ) -> None:
        self.busy: dict[Helper, int] = {}
        self.lost: list[Helper] = []
        self._idle = list(helpers)
        self._parts = parts
        self._observer = observer
        self._checkpoints = checkpoints
        self._waiting = deque(range(len(parts)))
        self._fractions = [0.0] * len(parts)
        self._results: dict[int, Any] = {}
        self._error: Exception | None = None
        self._own: int | None = None
        self._stopped_at_s: float | None = None

    def results(self) -> list[Any]:
        """In the order of the parts."""
        while len(self._results) < len(self._parts):
            self._serve(_WAIT_S)
            if self._error is not None:
                raise self._error
            if self._observer.is_cancelled():
                self._stop_helpers()
            if (index := self._next()) is not None:
                self._do(index)
        return [self._results[index] for index in range(len(self._parts))]

    def advanced(self, progress: Progress) -> None:
        self._serve()
        if self._own is not None:
            self._told(self._own, progress)

    def is_cancelled(self) -> bool:
        self._serve()
        return self._error is not None or self._observer.is_cancelled()

    def _do(self, index: int) -> None:
        self._own = index
        try:
            self._results[index] = self._parts[index].done(self, self._checkpoints)
        except Cancelled:
            # Of a helper's error, which says more.
            if self._error is None:
                raise
        finally:
            self._own = None
        self._fractions[index] = 1.0

    def _serve(self, wait_s: float = 0.0) -> None:
        """Hand out parts and hear what helpers say, waiting for a word if all parts are out."""
        for helper in [one for one in self._idle if one.is_ready]:
            taken = self._take()
            if taken is None:
                break
            self._idle.remove(helper)
            self._try_to_give(helper, *taken)
        for helper in list(self.busy):
            try:
                while helper in self.busy:
                    message = helper.heard(0.0 if self._waiting else wait_s)
                    if message is None:
                        break
                    self._heed(helper, message)
            except HelperLost as lost:
                self._lose(helper, lost)

    def _stop_helpers(self) -> None:
        now_s = time.monotonic()
        if self._stopped_at_s is None:
            self._stopped_at_s = now_s
            for helper in list(self.busy):
                try:
                    helper.stop()
                except HelperLost as lost:
                    self._lose(helper, lost)
        elif now_s > self._stopped_at_s + _STOPS_WITHIN_S:
            # Its part is done here, which ends at once, for all that is stopped.
            for helper in list(self.busy):
                helper.end()

    def _next(self) -> int | None:
        """Of the parts that wait. Helpers take them too, at any time."""
        try:
            return self._waiting.popleft()
        except IndexError:
            return None

    def _take(self) -> tuple[int, Part] | None:
        """For a helper, in its thread."""
        if self._stopped_at_s is not None or self._error is not None:
            return None
        index = self._next()
        return None if index is None else (index, self._parts[index])

    def _try_to_give(self, helper: Helper, index: int, part: Part) -> None:
        self.busy[helper] = index
        try:
            helper.give(part, self._take)
        except HelperLost as lost:
            self._lose(helper, lost)

    def _lose(self, helper: Helper, lost: HelperLost) -> None:
        index = self.busy.pop(helper)
        self.lost.append(helper)
        self._waiting.appendleft(index)
        _LOGGER.warning("a helper is lost, and its part is done again: %s", lost)

    def _heed(self, helper: Helper, message: Message) -> None:
        index = self.busy[helper]
        try:
            match message:
                case Advanced(progress):
                    self._hear_of(index, progress)
                case Load(key):
                    helper.answer(self._checkpoints.load(key))
                case Save(key, content):
                    self._checkpoints.save(key, content)
                case Done(result, then):
                    self._results[index] = result
                    self._fractions[index] = 1.0
                    if then is None:
                        self._idle.append(self._freed(helper))
                    else:
                        self.busy[helper] = then
                case Failed(error):
                    self._freed(helper)
                    self._error = self._error or error
        except HelperLost:
            raise
        except Exception as error:  # noqa: BLE001  it must not be taken for one of our own part's
            self._error = self._error or error

    def _freed(self, helper: Helper) -> Helper:
        del self.busy[helper]
        return helper

    def _hear_of(self, index: int, progress: Progress) -> None:
        """Our own part tells where the work is, a helper's only where there is none of ours."""
        self._come(index, progress.fraction)
        if self._own is None or progress.is_taken_up:
            self._told(index, progress)

    def _told(self, index: int, progress: Progress) -> None:
        self._come(index, progress.fraction)
        whole = sum(part.cost for part in self._parts)
        done = sum(f * part.cost for f, part in zip(self._fractions, self._parts, strict=True))
        fraction = min(done / whole, 1.0)
        self._observer.advanced(progress.model_copy(update={"fraction": fraction}))

    def _come(self, index: int, fraction: float) -> None:
        """Never back: what is done again has been told of."""
        self._fractions[index] = max(self._fractions[index], fraction)
