import time

from schemas.job import Progress, Stage
from worker.observer import Unobserved
from worker.stage_clock import StageClock


def test_each_stage_is_charged_for_its_own_time_and_no_more() -> None:
    now_s = iter([10.0, 10.0, 11.0, 11.5, 13.5])
    clock = StageClock(Unobserved(), lambda: next(now_s))
    for stage in (Stage.FITTING, Stage.FITTING, Stage.MESHING, Stage.FITTING):
        clock.advanced(Progress(stage=stage))
    assert clock.timings_s() == {"fitting": 3.0, "meshing": 0.5, "total": 3.5}


def test_the_clock_goes_by_itself() -> None:
    clock = StageClock(Unobserved())
    clock.advanced(Progress(stage=Stage.READING))
    time.sleep(0.01)
    assert clock.timings_s()["reading"] >= 0.01


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
