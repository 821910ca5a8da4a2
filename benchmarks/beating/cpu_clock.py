"""Processor time by stage and frame, from the progress that a run tells."""

import time
from collections.abc import Callable
from contextlib import suppress

import psutil

from schemas.job import Progress, Stage

_READ_EVERY_S = 0.2
"""Looking for child processes takes milliseconds."""


class CpuClock:
    """An observer. Where frames are fitted at the same time, which frame a second is counted for is
    by chance; their sum is right.
    """

    def __init__(
        self,
        cpu_s: Callable[[], float] | None = None,
        now_s: Callable[[], float] = time.monotonic,
    ) -> None:
        self.spent_s: dict[tuple[Stage, str | None], float] = {}
        self._cpu_s = cpu_s or family_cpu_s
        self._now_s = now_s
        self._key: tuple[Stage, str | None] = (Stage.WAITING, None)
        self._since_s = self._began_s = self._cpu_s()
        self._read_s = now_s()

    def advanced(self, progress: Progress) -> None:
        key = (progress.stage, progress.frame)
        if key == self._key or self._now_s() - self._read_s < _READ_EVERY_S:
            return
        self._close()
        self._key = key

    def is_cancelled(self) -> bool:
        return False

    def total_s(self) -> float:
        """Since the beginning."""
        self._close()
        return self._since_s - self._began_s

    def by_frame_s(self, stage: Stage) -> dict[str, float]:
        """Of one stage."""
        return {
            frame: round(spent_s, 3)
            for (told, frame), spent_s in self.spent_s.items()
            if told is stage and frame is not None
        }

    def _close(self) -> None:
        cpu_s = self._cpu_s()
        self.spent_s[self._key] = self.spent_s.get(self._key, 0.0) + cpu_s - self._since_s
        self._since_s, self._read_s = cpu_s, self._now_s()


def family_cpu_s() -> float:
    """Of this process, of its children, and of those that have ended."""
    own = psutil.Process()
    spent = own.cpu_times()
    total = spent.user + spent.system + spent.children_user + spent.children_system
    for child in own.children(recursive=True):
        with suppress(psutil.NoSuchProcess):  # it has just ended, and is counted next time
            times = child.cpu_times()
            total += times.user + times.system
    return float(total)
