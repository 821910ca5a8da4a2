"""Progress of a part of a job, told as progress of the whole."""

from dataclasses import dataclass

from schemas.job import Progress
from worker.observer import Observer


@dataclass(frozen=True)
class PartOfWhole:
    """Observes what lies between two fractions of the whole, for whoever observes all of it."""

    whole: Observer
    start: float
    end: float

    def part(self, start: float, end: float) -> "PartOfWhole":
        """From `start` to `end` of this part."""
        extent = self.end - self.start
        return PartOfWhole(self.whole, self.start + extent * start, self.start + extent * end)

    def advanced(self, progress: Progress) -> None:
        fraction = self.start + (self.end - self.start) * progress.fraction
        self.whole.advanced(progress.model_copy(update={"fraction": min(fraction, 1.0)}))

    def is_cancelled(self) -> bool:
        return self.whole.is_cancelled()
