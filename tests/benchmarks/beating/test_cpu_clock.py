"""Seconds go to the stage and frame that was told last."""

import time

import pytest

from benchmarks.beating.cpu_clock import CpuClock, family_cpu_s
from schemas.job import Progress, Stage


class Counter:
    """Reads what it is set to."""

    def __init__(self) -> None:
        self.s = 0.0

    def __call__(self) -> float:
        return self.s


def test_every_second_is_counted_once() -> None:
    cpu, now = Counter(), Counter()
    clock = CpuClock(cpu, now)
    for stage, frame in (
        (Stage.FITTING, "A"),
        (Stage.MESHING, "A"),
        (Stage.FITTING, "B"),
        (Stage.FITTING, "B"),
        (Stage.WRITING, None),
    ):
        cpu.s, now.s = cpu.s + 1.0, now.s + 1.0
        clock.advanced(Progress(stage=stage, frame=frame))
    cpu.s += 0.5
    assert clock.by_frame_s(Stage.FITTING) == {"A": 1.0, "B": 2.0}
    assert clock.total_s() == sum(clock.spent_s.values()) == 5.5
    assert not clock.is_cancelled()


def test_changes_in_quick_turns_are_not_each_looked_at() -> None:
    cpu, now = Counter(), Counter()
    clock = CpuClock(cpu, now)
    now.s = cpu.s = 1.0
    clock.advanced(Progress(stage=Stage.FITTING, frame="A"))
    now.s = cpu.s = 1.01
    clock.advanced(Progress(stage=Stage.FITTING, frame="B"))
    now.s = cpu.s = 2.0
    clock.advanced(Progress(stage=Stage.FITTING, frame="C"))
    assert clock.by_frame_s(Stage.FITTING) == {"A": 1.0}


def test_work_of_this_process_is_counted() -> None:
    before_s, used_s = family_cpu_s(), time.process_time()
    while time.process_time() - used_s < 0.2:
        pass
    assert family_cpu_s() - before_s == pytest.approx(0.2, abs=0.1)
