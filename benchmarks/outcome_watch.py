"""What an onlooker sees: when jobs end, by their folders, and when the service is ready."""

import threading
import time
from pathlib import Path
from types import TracebackType

from benchmarks.stack import is_ready

_LOOK_EVERY_S = 0.1


class OutcomeWatch:
    """Looks from a thread of its own for as long as the `with` block lasts.

    ended_s: by job, when its outcome was written, Unix time. rewritten: outcomes that changed, or
    went, after they were there. ready_s: instants at which the service said that it is ready.
    """

    def __init__(self, jobs_dir: Path, url: str) -> None:
        self.ended_s: dict[str, float] = {}
        self.rewritten: set[str] = set()
        self.ready_s: list[float] = []
        self._jobs_dir = jobs_dir
        self._url = url
        self._files: dict[str, tuple[int, int]] = {}
        self._stopping = threading.Event()
        self._threads = [
            threading.Thread(target=self._watch_outcomes, daemon=True),
            threading.Thread(target=self._watch_readiness, daemon=True),
        ]

    def __enter__(self) -> "OutcomeWatch":
        for thread in self._threads:
            thread.start()
        return self

    def __exit__(
        self,
        kind: type[BaseException] | None,
        error: BaseException | None,
        trace: TracebackType | None,
    ) -> None:
        self._stopping.set()
        for thread in self._threads:
            thread.join()

    def next_end_s(self, after_s: float) -> float | None:
        """How long after an instant a job ended; None where none did."""
        later = [at for at in list(self.ended_s.values()) if at > after_s]
        return min(later) - after_s if later else None

    def next_ready_s(self, after_s: float) -> float | None:
        """How long after an instant the service was ready; None where it never was."""
        return next((at - after_s for at in list(self.ready_s) if at > after_s), None)

    def _watch_outcomes(self) -> None:
        while not self._stopping.wait(_LOOK_EVERY_S):
            self._look()
        self._look()

    def _look(self) -> None:
        found: dict[str, tuple[int, int]] = {}
        for path in self._jobs_dir.glob("[0-9a-f]*/outcome.json"):
            stat = path.stat()
            found[path.parent.name] = stat.st_ino, stat.st_mtime_ns
        self.rewritten |= {id_ for id_, file in self._files.items() if found.get(id_) != file}
        for job_id in found.keys() - self.ended_s.keys():
            self.ended_s[job_id] = found[job_id][1] / 1e9
        self._files = found

    def _watch_readiness(self) -> None:
        while not self._stopping.wait(_LOOK_EVERY_S):
            asked_s = time.time()
            if is_ready(self._url):
                self.ready_s.append(asked_s)
