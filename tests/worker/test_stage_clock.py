import time

import pytest

from schemas.job import Progress, Stage
from worker.reconstruction.observer import Unobserved
from worker.stage_clock import StageClock


def test_each_stage_is_charged_for_its_own_time_and_no_more() -> None:
    clock = StageClock(Unobserved())
    clock.advanced(Progress(stage=Stage.FITTING))
    time.sleep(0.1)
    clock.advanced(Progress(stage=Stage.MESHING))
    time.sleep(0.05)
    clock.advanced(Progress(stage=Stage.FITTING))
    time.sleep(0.1)

    timings_s = clock.timings_s()

    assert timings_s["fitting"] >= 0.2
    assert 0.05 <= timings_s["meshing"] < timings_s["fitting"]
    stages_s = timings_s["fitting"] + timings_s["meshing"]
    assert timings_s["total"] == pytest.approx(stages_s, abs=0.01)


def test_everything_is_passed_on() -> None:
    seen: list[Progress] = []

    class Stops:
        def advanced(self, progress: Progress) -> None:
            seen.append(progress)

        def is_cancelled(self) -> bool:
            return True

    clock = StageClock(Stops())
    clock.advanced(Progress(stage=Stage.FITTING, fraction=0.5))
    assert seen == [Progress(stage=Stage.FITTING, fraction=0.5)]
    assert clock.is_cancelled()
