"""Progress of a part of the work, told as progress of the whole."""

from dataclasses import dataclass, replace

from schemas.job import Progress, Stage
from worker.observer import Observer


@dataclass(frozen=True)
class FrameShare:
    """Observes frame `index` of `count`, from `start` to `end` of it, for whoever observes all.

    stage: under which all of it is told, instead of under the stages that it goes through.
    """

    whole: Observer
    label: str
    index: int
    count: int
    start: float = 0.0
    end: float = 1.0
    stage: Stage | None = None

    def part(self, start: float, end: float) -> "FrameShare":
        """From `start` to `end` of this part."""
        extent = self.end - self.start
        return replace(self, start=self.start + extent * start, end=self.start + extent * end)

    def told_as(self, stage: Stage) -> "FrameShare":
        """The same part under another stage's name."""
        return replace(self, stage=stage)

    def advanced(self, progress: Progress) -> None:
        within = self.start + (self.end - self.start) * progress.fraction
        fraction = (self.index + within) / self.count
        told = {"fraction": fraction, "frame": self.label, "stage": self.stage or progress.stage}
        self.whole.advanced(progress.model_copy(update=told))

    def is_cancelled(self) -> bool:
        return self.whole.is_cancelled()
