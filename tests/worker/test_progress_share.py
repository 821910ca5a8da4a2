import pytest

from schemas.job import Progress, Stage
from worker.observer import Unobserved
from worker.progress_share import ProgressShare


class Watcher(Unobserved):
    def __init__(self) -> None:
        self.seen: list[Progress] = []

    def advanced(self, progress: Progress) -> None:
        self.seen.append(progress)


def test_a_part_of_a_part_runs_from_its_start_to_its_end() -> None:
    watcher = Watcher()
    part = ProgressShare(watcher, 0.5, 0.8)
    for fraction in (0.0, 0.5, 1.0):
        part.advanced(Progress(stage=Stage.MEASURING, frame="ED", fraction=fraction))
    assert [one.fraction for one in watcher.seen] == pytest.approx([0.5, 0.65, 0.8])
    assert {(one.stage, one.frame) for one in watcher.seen} == {(Stage.MEASURING, "ED")}
    assert not part.is_cancelled()
