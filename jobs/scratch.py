"""Private folders on this machine's disk for as long as their process lives.

A process that is killed leaves patients' data behind: each folder is locked by who uses it, the
kernel frees the lock with the process, and who makes the next folder removes what is not locked.
"""

import fcntl
import os
import shutil
import tempfile
from collections.abc import Iterator
from contextlib import contextmanager
from pathlib import Path


class Scratch:
    """The folder of such folders. Made where it is missing, readable by its owner only."""

    def __init__(self, root: Path) -> None:
        root.mkdir(mode=0o700, parents=True, exist_ok=True)
        self._root = root
        self._held: dict[Path, int] = {}
        with self._alone():
            self._sweep()

    def folder(self) -> Path:
        """A fresh folder, until it is dropped or this process ends."""
        with self._alone():
            self._sweep()
            path = Path(tempfile.mkdtemp(dir=self._root))
            lock = os.open(path, os.O_RDONLY | os.O_DIRECTORY)
            fcntl.flock(lock, fcntl.LOCK_EX | fcntl.LOCK_NB)
            self._held[path] = lock
        return path

    def drop(self, path: Path) -> None:
        """Remove a folder; one that is dropped already is nothing to do."""
        shutil.rmtree(path, ignore_errors=True)
        lock = self._held.pop(path, None)
        if lock is not None:
            os.close(lock)

    def _sweep(self) -> None:
        for path in self._root.iterdir():
            if not path.is_dir() or path in self._held:
                continue
            lock = os.open(path, os.O_RDONLY | os.O_DIRECTORY)
            try:
                fcntl.flock(lock, fcntl.LOCK_EX | fcntl.LOCK_NB)
            except BlockingIOError:
                continue  # in use
            else:
                shutil.rmtree(path, ignore_errors=True)
            finally:
                os.close(lock)

    @contextmanager
    def _alone(self) -> Iterator[None]:
        """While folders are made or swept, nobody else does."""
        lock = os.open(self._root / ".lock", os.O_RDWR | os.O_CREAT, 0o600)
        try:
            fcntl.flock(lock, fcntl.LOCK_EX)
            yield
        finally:
            os.close(lock)
