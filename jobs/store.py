"""All job folders under one root, and the ids that name them."""

import contextlib
import os
import re
import secrets
import shutil
import threading
import time
from pathlib import Path

from jobs.folder import ERASED_PREFIX, NEW_PREFIX, JobFolder

JOB_ID_PATTERN = r"^[0-9a-f]{32}$"

_JOB_ID = re.compile(JOB_ID_PATTERN)
_ABANDONED_AFTER_S = 3600.0
_NO_JOBS = ("lost+found",)


def is_job_id(text: str) -> bool:
    """Whether the text may name a job: to be asked before it touches a path."""
    return _JOB_ID.fullmatch(text) is not None


def made_at_s(job_id: str) -> float:
    """When the id was made, Unix time."""
    return int(job_id[:12], 16) / 1000


class JobStore:
    """The folder of job folders. Made where it is missing, readable by its owner only."""

    def __init__(self, root: Path) -> None:
        self.root = root
        root.mkdir(mode=0o700, parents=True, exist_ok=True)
        self._last_id = 0
        self._first_seen_s: dict[str, float] = {}
        self._lock = threading.Lock()

    def new_id(self) -> str:
        """48 bits of Unix time in ms, then 80 random bits, as 32 hex digits.

        Ids sort by the time they were made; within one process strictly.
        """
        drawn = (time.time_ns() // 1_000_000) << 80 | secrets.randbits(80)
        with self._lock:
            self._last_id = max(drawn, self._last_id + 1)
            return f"{self._last_id:032x}"

    def folder(self, job_id: str) -> JobFolder:
        """The folder of a job. Raises ValueError for what cannot be a job id."""
        if not is_job_id(job_id):
            raise ValueError("not a job id: 32 hexadecimal digits are")
        return JobFolder(self.root, job_id)

    def ids(self) -> list[str]:
        """Ids of every job that has a folder, oldest first."""
        return sorted(entry.name for entry in os.scandir(self.root) if is_job_id(entry.name))

    def strangers(self) -> list[Path]:
        """Folders whose names are neither a job's nor of this program's making.

        Hidden ones are left alone, and what a file system has of its own.
        """
        return sorted(
            Path(entry.path)
            for entry in os.scandir(self.root)
            if entry.is_dir(follow_symlinks=False)
            and not (is_job_id(entry.name) or entry.name.startswith(".") or entry.name in _NO_JOBS)
        )

    def is_writable(self) -> bool:
        """Whether a file can be made here now."""
        probe = self.root / f".probe-{secrets.token_hex(6)}"
        try:
            probe.write_bytes(b"x")
        except OSError:
            return False
        finally:
            # A full disk still takes the name of a file, though not its byte.
            with contextlib.suppress(OSError):
                probe.unlink()
        return True

    def sweep(self) -> None:
        """Remove what a crash left: erasures half done, and submissions that were never shown.

        Nothing is lost by it: an erased job was to go, and nobody was told of a job that was not
        shown. The latter are given an hour from when this process first saw them, by a clock that
        does not jump: one may still be being written.
        """
        now_s = time.monotonic()
        names = [entry.name for entry in os.scandir(self.root)]
        first_seen_s = self._first_seen_s
        self._first_seen_s = {
            name: first_seen_s.get(name, now_s) for name in names if name.startswith(NEW_PREFIX)
        }
        abandoned = [
            name
            for name, seen_s in self._first_seen_s.items()
            if now_s - seen_s >= _ABANDONED_AFTER_S
        ]
        for name in (*(n for n in names if n.startswith(ERASED_PREFIX)), *abandoned):
            # Another process may be erasing the same folder.
            shutil.rmtree(self.root / name, ignore_errors=True)
