"""A periodic thread lives as long as its block, and no pause outlasts it."""

import threading
import time
from contextvars import ContextVar

from jobs.periodic_thread import PeriodicThread

ABOUT = ContextVar("ABOUT", default="nothing")


class Counting(PeriodicThread):
    """Counts its rounds, and remembers what it was about."""

    def __init__(self, every_s: float, join_within_s: float | None = None) -> None:
        super().__init__("counting", join_within_s)
        self.every_s = every_s
        self.rounds = 0
        self.about = ""
        self.has_begun = threading.Event()
        self.has_ended = threading.Event()

    def _run(self) -> None:
        self.about = ABOUT.get()
        while self._pause(self.every_s):
            self.rounds += 1
            self.has_begun.set()
        self.has_ended.set()


def test_it_goes_round_until_it_is_left() -> None:
    with Counting(0.01) as thread:
        assert thread.has_begun.wait(20.0)
        assert not thread.has_ended.is_set()
    assert thread.has_ended.is_set()
    rounds = thread.rounds
    time.sleep(0.05)
    assert thread.rounds == rounds > 0


def test_a_long_pause_ends_with_the_block() -> None:
    with Counting(3600.0) as thread:
        pass
    assert thread.has_ended.is_set()
    assert thread.rounds == 0


def test_it_speaks_of_what_its_maker_was_about() -> None:
    token = ABOUT.set("a job")
    thread = Counting(0.01)
    ABOUT.reset(token)
    with thread:
        assert thread.has_begun.wait(20.0)
    assert thread.about == "a job"


def test_leaving_waits_no_longer_than_told() -> None:
    release = threading.Event()

    class Stuck(Counting):
        def _run(self) -> None:
            self.has_begun.set()
            release.wait(20.0)
            self.has_ended.set()

    with Stuck(0.0, join_within_s=0.01) as thread:
        assert thread.has_begun.wait(20.0)
    assert not thread.has_ended.is_set()
    release.set()
    assert thread.has_ended.wait(20.0)
