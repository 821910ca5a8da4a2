"""Progress of a part of the work, told as progress of the whole."""

from dataclasses import dataclass

from schemas.job import Progress
from worker.observer import Observer


@dataclass(frozen=True)
class FrameShare:
    """Observes frame `index` of `count`, from `start` to `end` of it, for whoever observes all."""

    whole: Observer
    label: str
    index: int
    count: int
    start: float = 0.0
    end: float = 1.0

    def part(self, start: float, end: float) -> "FrameShare":
        """The same frame, from `start` to `end` of it."""
        return FrameShare(self.whole, self.label, self.index, self.count, start, end)

    def advanced(self, progress: Progress) -> None:
        within = self.start + (self.end - self.start) * progress.fraction
        fraction = (self.index + within) / self.count
        self.whole.advanced(progress.model_copy(update={"fraction": fraction, "frame": self.label}))

    def is_cancelled(self) -> bool:
        return self.whole.is_cancelled()
