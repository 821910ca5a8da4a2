"""A second process of our own that does parts of a job: the parent's end of it.

Not `multiprocessing`: a Celery child is daemonic, and may have no child of that kind. What goes
between the two is pickled, over a pipe that nobody else has.
"""

import os
import subprocess
import sys
from dataclasses import dataclass
from multiprocessing import Pipe
from typing import Any

from schemas.job import Progress
from worker.crew import Part
from worker.own_pipe import receive, send


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
    """The part's result."""

    result: Any


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


Message = Advanced | Load | Save | Done | Failed
"""What a helper says. It speaks of the part that it was given last."""


class HelperLost(Exception):  # noqa: N818 - what happened, not "Error"
    """The helper has ended: killed, out of memory. Its part is to be done again."""


class Helper:
    """Does one part at a time. Starts at once, ends with this process, however that ends."""

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

    @property
    def pid(self) -> int:
        return self._process.pid

    def give(self, part: Part) -> None:
        """Have it do a part. Raises HelperLost."""
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
            message: Message | None = receive(self._pipe) if self._pipe.poll(wait_s) else None
        except (EOFError, OSError) as error:
            raise HelperLost(f"process {self.pid} has ended") from error
        return message

    def end(self) -> None:
        """End it, whatever it does."""
        self._process.kill()
        self._process.wait()
        self._pipe.close()

    def _send(self, what: Part | Held | Stop) -> None:
        try:
            send(self._pipe, what)
        except OSError as error:
            raise HelperLost(f"process {self.pid} has ended") from error
