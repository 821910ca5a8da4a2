"""Real helper processes: the same results as alone, whatever becomes of a helper."""

import os
import subprocess
import sys
import time
from collections.abc import Callable, Iterator
from contextlib import contextmanager
from pathlib import Path

import psutil
import pytest

from schemas.job import Progress
from schemas.problem import InternalError, ProblemType
from tests.worker import crew_parts
from tests.worker.kept import Kept
from worker.checkpoints import Unkept
from worker.crew import Alone, Crew, Part
from worker.helped_crew import HelpedCrew, crew_of
from worker.observer import Cancelled, Unobserved

HELPED = """
import os, sys, time
from worker.helped_crew import crew_of
with crew_of(2, 1) as crew:
    print(crew.helpers[0].pid, flush=True)
    time.sleep(60)
"""


class Listener(Unobserved):
    def __init__(self, stop: Callable[[], bool] = lambda: False) -> None:
        self.fractions: list[float] = []
        self.stop = stop

    def advanced(self, progress: Progress) -> None:
        self.fractions.append(progress.fraction)

    def is_cancelled(self) -> bool:
        return self.stop()


@contextmanager
def ready_crew(processes: int) -> Iterator[Crew]:
    """One whose helpers have begun to wait for parts."""
    with crew_of(processes, 1) as crew:
        assert isinstance(crew, HelpedCrew)
        deadline = time.monotonic() + 60.0
        while not all(helper.is_ready for helper in crew.helpers):
            assert time.monotonic() < deadline
            time.sleep(0.02)
        yield crew


def helpers() -> list[psutil.Process]:
    return [
        one
        for one in psutil.Process().children()
        if one.status() != psutil.STATUS_ZOMBIE and "worker.helper_main" in one.cmdline()
    ]


def test_parts_are_shared_out_and_come_back_in_their_order() -> None:
    parts = [Part(crew_parts.slow_square, (number,)) for number in range(40)]
    heard = Listener()
    with ready_crew(2) as crew:
        found = crew.all_of(parts, heard, Unkept())
        again = crew.all_of(parts[:3], Unobserved(), Unkept())
    assert [square for square, _ in found] == [number**2 for number in range(40)]
    assert [square for square, _ in again] == [0, 1, 4]
    assert len({pid for _, pid in found}) == 2
    assert heard.fractions == sorted(heard.fractions)
    assert 0.9 < heard.fractions[-1] <= 1.0
    assert not helpers()


def test_one_process_is_enough() -> None:
    parts = [Part(crew_parts.slow_square, (number,)) for number in range(3)]
    with crew_of(1, 1) as crew:
        assert isinstance(crew, Alone)
        found = crew.all_of(parts, Unobserved(), Unkept())
    assert found == [(number**2, os.getpid()) for number in range(3)]


def test_helpers_load_and_save_where_their_parent_does() -> None:
    kept = Kept({"a": b"111"})
    parts = [Part(crew_parts.counted, (key,)) for key in "abcdef"]
    with ready_crew(3) as crew:
        found = crew.all_of(parts, Unobserved(), kept)
    assert found == [b"1111", *[b"1"] * 5]
    assert kept.held == dict(zip("abcdef", found, strict=True))


def test_the_error_of_a_helper_is_raised_here_as_it_was() -> None:
    # The helper has the first part, and this process is busy with the other.
    parts = [Part(crew_parts.failing, (os.getpid(),)) for _ in range(2)]
    with ready_crew(2) as crew, pytest.raises(InternalError, match="Nothing is there") as caught:
        crew.all_of(parts, Unobserved(), Unkept())
    assert caught.value.type is ProblemType.NO_SURFACE
    assert caught.value.pointer == "/study"
    assert any("crew_parts.py" in note for note in caught.value.__notes__)


def test_a_part_whose_helper_was_killed_is_done_here(
    tmp_path: Path, caplog: pytest.LogCaptureFixture
) -> None:
    parts = [Part(crew_parts.dying, (os.getpid(), tmp_path / "mark")) for _ in range(3)]
    with ready_crew(2) as crew:
        assert crew.all_of(parts, Unobserved(), Unkept()) == ["done"] * 3
        # And goes on without it.
        assert crew.all_of(parts, Unobserved(), Unkept()) == ["done"] * 3
    assert "a helper is lost" in caplog.text


def test_helpers_are_stopped_with_their_parent() -> None:
    asked_from = time.monotonic()
    parts = [Part(crew_parts.working, (os.getpid(),)) for _ in range(2)]
    with ready_crew(2) as crew:
        with pytest.raises(Cancelled):
            crew.all_of(parts, Listener(lambda: time.monotonic() > asked_from + 0.5), Unkept())
        assert not helpers()


def test_helpers_are_stopped_while_their_parent_waits_for_them() -> None:
    started = time.monotonic()
    parts = [Part(crew_parts.working, (os.getpid(),)), Part(crew_parts.counted, ("a",))]
    with ready_crew(2) as crew, pytest.raises(Cancelled):
        crew.all_of(parts, Listener(lambda: time.monotonic() > started + 0.5), Unkept())
    assert not helpers()


def test_helpers_that_do_not_stop_in_time_are_ended_and_what_others_have_is_kept() -> None:
    started = time.monotonic()
    parts = [Part(crew_parts.stubborn, (os.getpid(),)), Part(crew_parts.until_stopped, ())]
    with ready_crew(2) as crew:
        found = crew.all_of(parts, Listener(lambda: time.monotonic() > started + 0.5), Unkept())
        assert not helpers()
    assert found == ["stopped here", "stopped"]


def test_a_part_is_not_given_to_a_helper_that_is_not_ready() -> None:
    parts = [Part(crew_parts.counted, (key,)) for key in "ab"]
    with crew_of(2, 1) as crew:
        assert isinstance(crew, HelpedCrew)
        assert crew.all_of(parts, Unobserved(), Kept()) == [b"1", b"1"]
        assert not crew.helpers[0].is_ready, "it is still loading, and nobody waited for it"


def test_what_cannot_go_to_a_helper_is_said() -> None:
    parts = [Part(crew_parts.counted, (key,)) for key in "ab"]
    unsendable = Part(lambda *_: b"1", ())
    with ready_crew(2) as crew, pytest.raises(Exception, match=r"pickle|local"):
        crew.all_of([unsendable, *parts], Unobserved(), Kept())


@pytest.mark.skipif(not sys.platform.startswith("linux"), reason="prctl is Linux's")
def test_a_helper_ends_with_a_parent_that_was_killed() -> None:
    parent = subprocess.Popen([sys.executable, "-c", HELPED], stdout=subprocess.PIPE, text=True)
    assert parent.stdout is not None
    with parent.stdout:
        helper = psutil.Process(int(parent.stdout.readline()))
    parent.kill()
    parent.wait()
    deadline = time.monotonic() + 20.0
    while helper.is_running() and helper.status() != psutil.STATUS_ZOMBIE:
        assert time.monotonic() < deadline
        time.sleep(0.02)
