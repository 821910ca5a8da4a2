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
        """Remove what a crash left: erasures half done, and submissions that were never shown."""
        oldest = time.time() - _ABANDONED_AFTER_S
        for entry in os.scandir(self.root):
            erased = entry.name.startswith(ERASED_PREFIX)
            if erased or (entry.name.startswith(NEW_PREFIX) and _made_before(entry, oldest)):
                # Another process may be erasing the same folder.
                shutil.rmtree(entry.path, ignore_errors=True)


def _made_before(entry: "os.DirEntry[str]", instant: float) -> bool:
    """Whether the entry is older; one that was renamed since it was listed is not."""
    try:
        return entry.stat(follow_symlinks=False).st_mtime < instant
    except FileNotFoundError:
        return False
