"""The processes that a command starts and takes down again, every one of them, whatever happens."""

import os
import signal
import subprocess
import sys
from collections.abc import Mapping
from contextlib import suppress
from dataclasses import dataclass
from functools import partial
from pathlib import Path

from schemas.problem import InternalError, ProblemType
from worker.parent_death import die_with_parent

_LOG_TAIL_LINES = 15
_STOPS_WITHIN_S = 10.0


@dataclass(frozen=True)
class Child:
    """One process of ours. It writes to its own log, and leads a process group of its own, so that
    Ctrl-C reaches us alone and we stop the children in order.
    """

    name: str
    process: "subprocess.Popen[bytes]"
    log: Path

    def stop(self) -> None:
        """Ask it to end, wait, and kill it with all its children where it does not."""
        if self.process.poll() is None:
            self.process.terminate()
        try:
            self.process.wait(_STOPS_WITHIN_S)
        except subprocess.TimeoutExpired:
            os.killpg(self.process.pid, signal.SIGKILL)
            self.process.wait()

    def last_words(self) -> str:
        lines = self.log.read_text(encoding="utf-8", errors="replace").splitlines()
        return "\n".join(lines[-_LOG_TAIL_LINES:])


class Children:
    """Processes in the order in which they were started; they die with us even if we are killed."""

    def __init__(self, log_dir: Path) -> None:
        self._log_dir = log_dir
        self._children: list[Child] = []
        log_dir.mkdir(parents=True, exist_ok=True)

    def start(
        self,
        name: str,
        command: list[str],
        *,
        env: Mapping[str, str] | None = None,
        stdin: str | None = None,
        if_orphaned: signal.Signals = signal.SIGKILL,
    ) -> "subprocess.Popen[bytes]":
        """Start a process.

        Args:
            name: Of its log, and in messages.
            command: Program and arguments.
            env: Its whole environment; None for ours.
            stdin: What it reads on standard input; None for nothing.
            if_orphaned: What the kernel sends it when this process is gone.
        """
        log = self._log_dir / f"{name}.log"
        with log.open("ab") as output:
            process = subprocess.Popen(  # noqa: S603  every command here is our own
                command,
                env=env,
                cwd=self._log_dir,
                stdin=subprocess.DEVNULL if stdin is None else subprocess.PIPE,
                stdout=output,
                stderr=subprocess.STDOUT,
                start_new_session=True,
                preexec_fn=partial(die_with_parent, os.getpid(), if_orphaned),
            )
        self._children.append(Child(name, process, log))
        if process.stdin is not None and stdin is not None:
            # One that has ended already reads nothing; that it ended is `check`'s to tell.
            with suppress(BrokenPipeError), process.stdin as pipe:
                pipe.write(stdin.encode())
        return process

    def check(self) -> None:
        """Raise InternalError with the last lines of its log where a process has ended."""
        for child in self._children:
            code = child.process.poll()
            if code is not None:
                raise InternalError(
                    ProblemType.UNAVAILABLE,
                    f"{child.name} ended by itself with code {code}; its log is {child.log}:\n"
                    f"{child.last_words()}",
                )

    def forget_ended(self) -> None:
        """Drop the processes that have ended: somebody else has dealt with them."""
        self._children = [c for c in self._children if c.process.poll() is None]

    def stop(self) -> None:
        """End all of them, the last started first."""
        for child in reversed(self._children):
            child.stop()
        self._children = []


def python_module(module: str, *arguments: str) -> list[str]:
    """A command that runs a module of this environment, whatever lies in the working folder."""
    return [sys.executable, "-P", "-m", module, *arguments]
