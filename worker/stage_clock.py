"""An observer that takes the time of each stage and passes everything on."""

import time
from collections.abc import Callable

from schemas.job import Progress, Stage
from worker.observer import Observer


class StageClock:
    """Wall time by stage, from the progress that goes through it. `now_s` is read for seconds."""

    def __init__(self, observer: Observer, now_s: Callable[[], float] = time.perf_counter) -> None:
        self._observer = observer
        self._now_s = now_s
        self._seconds: dict[Stage, float] = {}
        self._stage: Stage | None = None
        self._since_s = self._started_s = now_s()

    def advanced(self, progress: Progress) -> None:
        if progress.stage is not self._stage:
            self._close()
            self._stage = progress.stage
        self._observer.advanced(progress)

    def is_cancelled(self) -> bool:
        return self._observer.is_cancelled()

    def timings_s(self) -> dict[str, float]:
        """Seconds spent in each stage up to now, and `total`."""
        timings = {stage.value: seconds for stage, seconds in self.stage_s().items()}
        return {**timings, "total": round(self._since_s - self._started_s, 3)}

    def stage_s(self) -> dict[Stage, float]:
        """Seconds spent in each stage up to now."""
        self._close()
        return {stage: round(seconds, 3) for stage, seconds in self._seconds.items()}

    def _close(self) -> None:
        now_s = self._now_s()
        if self._stage is not None:
            spent_s = self._seconds.get(self._stage, 0.0)
            self._seconds[self._stage] = spent_s + now_s - self._since_s
        self._since_s = now_s
