"""One process of the service that may be killed, and is started again as it was."""

import os
import signal
import subprocess
from collections.abc import Mapping, Sequence
from functools import partial
from pathlib import Path

import psutil

from worker.parent_death import die_with_parent


class Member:
    """A command with its environment. It must be started by the main thread: the kernel ends it
    with the thread that started it.
    """

    def __init__(
        self, name: str, command: Sequence[str], env: Mapping[str, str], log_dir: Path
    ) -> None:
        self.name = name
        self._command = list(command)
        self._env = dict(env)
        self._log = log_dir / f"{name}.log"
        self._process: subprocess.Popen[bytes] | None = None

    @property
    def pid(self) -> int:
        return self._running().pid

    @property
    def is_running(self) -> bool:
        return self._process is not None and self._process.poll() is None

    def start(self) -> None:
        with self._log.open("ab") as output:
            self._process = subprocess.Popen(
                self._command,
                env=self._env,
                stdin=subprocess.DEVNULL,
                stdout=output,
                stderr=subprocess.STDOUT,
                start_new_session=True,
                preexec_fn=partial(die_with_parent, os.getpid()),
            )

    def kill(self) -> None:
        """An end without a word, of its children too."""
        for child in self.children():
            _send(child, signal.SIGKILL)
        self._running().kill()
        self._running().wait()

    def stop(self, within_s: float = 30.0) -> None:
        """Ask it to end, and see that it does."""
        if not self.is_running:
            return
        self._running().terminate()
        try:
            self._running().wait(within_s)
        except subprocess.TimeoutExpired:
            self.kill()

    def children(self) -> list[psutil.Process]:
        """Processes below it now."""
        return psutil.Process(self.pid).children(recursive=True) if self.is_running else []

    def send_to_all(self, sign: signal.Signals) -> None:
        """Signal it and its children."""
        for process in [psutil.Process(self.pid), *self.children()]:
            _send(process, sign)

    def _running(self) -> "subprocess.Popen[bytes]":
        if self._process is None:
            raise RuntimeError(f"{self.name} was never started")
        return self._process


def _send(process: psutil.Process, sign: signal.Signals) -> None:
    try:
        process.send_signal(sign)
    except psutil.NoSuchProcess:
        return  # it was faster
