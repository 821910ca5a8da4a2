"""`neuralmri serve` as a user runs it: a process of its own, with a data folder and a port."""

import os
import select
import signal
import subprocess
import sysconfig
import time
from functools import partial
from pathlib import Path

import psutil

from tests.redis_server import free_port
from worker.parent_death import die_with_parent

NEURALMRI = str(Path(sysconfig.get_path("scripts")) / "neuralmri")
_READY_WITHIN_S = 90.0


class ServeProcess:
    """One server. Its settings make lost workers noticed in seconds."""

    def __init__(
        self, data_dir: Path, *options: str, port: int | None = None, processes: int = 1
    ) -> None:
        self.port = port or free_port()
        self.url = f"http://127.0.0.1:{self.port}"
        self.data_dir = data_dir
        self.process = subprocess.Popen(
            [
                *(NEURALMRI, "serve", "--port", str(self.port), "--data-dir", str(data_dir)),
                *("--workers", "1"),
                *options,
            ],
            env={
                **os.environ,
                "NEURALMRI_PROCESSES": str(processes),
                "NEURALMRI_LEASE_S": "2",
                "NEURALMRI_LOST_AFTER_S": "1",
                "NEURALMRI_RECONCILE_EVERY_S": "1",
            },
            stdin=subprocess.DEVNULL,
            stdout=subprocess.PIPE,
            stderr=subprocess.PIPE,
            preexec_fn=partial(_as_a_users, os.getpid()),
        )

    def wait_until_ready(self) -> "ServeProcess":
        """The one line that says so has been printed."""
        assert self.process.stdout is not None
        readable, _, _ = select.select([self.process.stdout], [], [], _READY_WITHIN_S)
        line = self.process.stdout.readline().decode() if readable else ""
        if self.url not in line:
            self.process.kill()
            _, error = self.process.communicate()
            raise RuntimeError(f"the server did not start: {line}{error.decode()}")
        return self

    def family(self) -> list[psutil.Process]:
        """Every process below the server."""
        return psutil.Process(self.process.pid).children(recursive=True)

    def child(self, words: str) -> psutil.Process:
        """The server's own child whose command line holds `words`."""
        children = psutil.Process(self.process.pid).children()
        (found,) = [child for child in children if words in " ".join(child.cmdline())]
        return found

    def worker_child(self) -> psutil.Process:
        """The process that computes."""
        (found,) = self.child("worker.app").children()
        return found

    def stop(self) -> tuple[int, str]:
        """SIGTERM; its exit code and what it said on standard error."""
        if self.process.poll() is None:
            self.process.send_signal(signal.SIGTERM)
        return self.end()

    def end(self) -> tuple[int, str]:
        """Wait for its end; exit code and standard error."""
        _, error = self.process.communicate(timeout=60)
        return self.process.returncode, error.decode()


def _as_a_users(parent_pid: int) -> None:
    """In the server before it starts: it ends with the tests, and listens to Ctrl-C.

    Where the tests run in the background of a script they ignore Ctrl-C, and so would it.
    """
    signal.signal(signal.SIGINT, signal.SIG_DFL)
    die_with_parent(parent_pid, signal.SIGTERM)


def gone(processes: list[psutil.Process], within_s: float) -> list[psutil.Process]:
    """Those that are still there after `within_s`."""
    deadline = time.monotonic() + within_s
    left = processes
    while left and time.monotonic() < deadline:
        left = [p for p in left if p.is_running() and p.status() != psutil.STATUS_ZOMBIE]
        time.sleep(0.05)
    return left
