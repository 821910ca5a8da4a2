"""Progress of a part of the work, told as progress of the whole."""

from dataclasses import dataclass

from schemas.job import Progress
from worker.observer import Observer


@dataclass(frozen=True)
class ProgressShare:
    """Observes the part of the work from `start` to `end`, for whoever observes all of it."""

    whole: Observer
    start: float = 0.0
    end: float = 1.0

    def advanced(self, progress: Progress) -> None:
        fraction = min(self.start + (self.end - self.start) * progress.fraction, 1.0)
        self.whole.advanced(progress.model_copy(update={"fraction": fraction}))

    def is_cancelled(self) -> bool:
        return self.whole.is_cancelled()
