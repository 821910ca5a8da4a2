"""A second process of our own that does parts of a job: the parent's end of it.

Not `multiprocessing`: a Celery child is daemonic, and may have no child of that kind. What goes
between the two is pickled, over a pipe that nobody else has.
"""

import os
import subprocess
import sys
from collections.abc import Callable
from dataclasses import dataclass
from multiprocessing import Pipe
from queue import Empty, SimpleQueue
from threading import Event, Lock, Thread
from typing import Any

from schemas.job import Progress
from worker.crew import Part
from worker.own_pipe import receive, send


@dataclass(frozen=True)
class Ready:
    """It has loaded what parts need."""


@dataclass(frozen=True)
class Advanced:
    """The part has come this far."""

    progress: Progress


@dataclass(frozen=True)
class Load:
    """What is kept under the key? Answered by bytes or None."""

    key: str


@dataclass(frozen=True)
class Save:
    """Keep this under the key."""

    key: str
    content: bytes


@dataclass(frozen=True, eq=False)
class Done:
    """The part's result. then: the place of the part that it was given at once after it."""

    result: Any
    then: int | None = None


@dataclass(frozen=True, eq=False)
class Failed:
    """The part raised this; its traceback is among the notes."""

    error: Exception


@dataclass(frozen=True)
class Stop:
    """To a helper: end the part that it has."""


@dataclass(frozen=True)
class Held:
    """To a helper: what is kept under the key that it asked for."""

    content: bytes | None


Message = Ready | Advanced | Load | Save | Done | Failed
"""What a helper says. It speaks of the part that it was given last."""


Take = Callable[[], tuple[int, Part] | None]
"""The next part, and its place among all; None where there is none. Called in another thread."""


class HelperLost(Exception):  # noqa: N818 - what happened, not "Error"
    """The helper has ended: killed, out of memory. Its part is to be done again."""


class Helper:
    """Does one part at a time. Starts at once, ends with this process, however that ends.

    A thread takes what it says from the pipe, and gives it the next part: it never waits until this
    process has a moment for it.
    """

    def __init__(self, threads: int) -> None:
        """threads: of its arithmetic."""
        self._pipe, theirs = Pipe()
        try:
            self._process = subprocess.Popen(  # noqa: S603  ourselves
                [
                    *(sys.executable, "-P", "-m", "worker.helper_main"),
                    *(str(number) for number in (theirs.fileno(), os.getpid(), threads)),
                ],
                env={**os.environ, "PYTHONPATH": os.pathsep.join(sys.path)},
                pass_fds=[theirs.fileno()],
                stdin=subprocess.DEVNULL,
                # Ctrl-C is for us: we end it.
                process_group=0,
            )
        finally:
            theirs.close()
        self._said: SimpleQueue[Message | None] = SimpleQueue()
        self._take: Take = _nothing
        self._sending = Lock()
        self._is_ready = Event()
        self._listener = Thread(target=self._listen, daemon=True)
        self._listener.start()

    @property
    def pid(self) -> int:
        return self._process.pid

    @property
    def is_ready(self) -> bool:
        """Whether a part that it is given is begun at once. Never again for one that has ended."""
        return self._is_ready.is_set()

    def give(self, part: Part, take: Take) -> None:
        """Have it do a part, and afterwards what it takes. Raises HelperLost."""
        self._take = take
        self._send(part)

    def answer(self, content: bytes | None) -> None:
        """To its last Load. Raises HelperLost."""
        self._send(Held(content))

    def stop(self) -> None:
        """Ask it to end its part. Raises HelperLost."""
        self._send(Stop())

    def heard(self, wait_s: float = 0.0) -> Message | None:
        """What it said, if within `wait_s` it has said something. Raises HelperLost."""
        try:
            message = self._said.get(wait_s > 0.0, wait_s or None)
        except Empty:
            return None
        if message is None:
            raise HelperLost(f"process {self.pid} has ended")
        return message

    def end(self) -> None:
        """End it, whatever it does."""
        self._process.kill()
        self._process.wait()
        self._listener.join()
        self._pipe.close()

    def _listen(self) -> None:
        try:
            while True:
                message = receive(self._pipe)
                if isinstance(message, Ready):
                    self._is_ready.set()
                elif isinstance(message, Done):
                    self._go_on(message)
                else:
                    self._said.put(message)
        except (EOFError, OSError):
            self._is_ready.clear()
        except Exception as error:  # noqa: BLE001  raised where it is heard of
            self._said.put(Failed(error))
        finally:
            self._said.put(None)

    def _go_on(self, done: Done) -> None:
        # In one go, so that a Stop is of the part before or of the part after.
        with self._sending:
            taken = self._take()
            if taken is None:
                self._said.put(done)
            else:
                index, part = taken
                self._said.put(Done(done.result, index))
                send(self._pipe, part)

    def _send(self, what: Part | Held | Stop) -> None:
        try:
            with self._sending:
                send(self._pipe, what)
        except OSError as error:
            raise HelperLost(f"process {self.pid} has ended") from error


def _nothing() -> tuple[int, Part] | None:
    return None
