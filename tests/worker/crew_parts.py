"""Parts of work that another process can find by name."""

import os
import signal
import time
from pathlib import Path

from schemas.job import Progress, Stage
from schemas.problem import InternalError, ProblemType
from worker.checkpoints import Checkpoints
from worker.observer import Cancelled, Observer


def slow_square(number: int, observer: Observer, _: Checkpoints) -> tuple[int, int]:
    """Its square, and the process that took it."""
    for step in range(5):
        observer.advanced(Progress(stage=Stage.FITTING, fraction=step / 5))
        if observer.is_cancelled():
            raise Cancelled
        time.sleep(0.05)
    return number**2, os.getpid()


def counted(key: str, _: Observer, checkpoints: Checkpoints) -> bytes:
    """One more than was counted last."""
    content = (checkpoints.load(key) or b"") + b"1"
    checkpoints.save(key, content)
    return content


def failing(parent: int, observer: Observer, _: Checkpoints) -> None:
    """Fails in a helper, and works until it is stopped in its parent."""
    if os.getpid() != parent:
        raise InternalError(ProblemType.NO_SURFACE, "Nothing is there.", pointer="/study")
    working(parent, observer, _)


def working(_parent: int, observer: Observer, _: Checkpoints) -> None:
    """Works until it is stopped."""
    deadline = time.monotonic() + 60.0
    while time.monotonic() < deadline:
        if observer.is_cancelled():
            raise Cancelled
        time.sleep(0.01)


def dying(parent: int, mark: Path, observer: Observer, _: Checkpoints) -> str:
    """Kills a helper that does it; its parent waits for that, and then does both."""
    if os.getpid() != parent:
        mark.touch()
        os.kill(os.getpid(), signal.SIGKILL)
    while not mark.exists():
        observer.is_cancelled()
        time.sleep(0.01)
    return "done"


def until_stopped(observer: Observer, _: Checkpoints) -> str:
    """Returns what it has when it is stopped."""
    while not observer.is_cancelled():
        time.sleep(0.01)
    return "stopped"


def stubborn(parent: int, observer: Observer, _: Checkpoints) -> str:
    """Heeds nothing in a helper."""
    if os.getpid() == parent:
        return "stopped here" if observer.is_cancelled() else "not stopped"
    time.sleep(60.0)
    return "never"
