"""Progress of a part of one frame's work."""

from dataclasses import dataclass, replace

from schemas.job import Progress, Stage
from worker.observer import Observer
from worker.progress_share import ProgressShare


@dataclass(frozen=True)
class FrameShare:
    """Observes the part of a frame's work from `start` to `end`, for whoever observes all frames.

    stage: under which all of it is told, instead of under the stages that it goes through.
    """

    whole: Observer
    label: str
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
        told = {"frame": self.label, "stage": self.stage or progress.stage}
        share = ProgressShare(self.whole, self.start, self.end)
        share.advanced(progress.model_copy(update=told))

    def is_cancelled(self) -> bool:
        return self.whole.is_cancelled()
