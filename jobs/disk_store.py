"""Job folders under one root on a disk of this machine, or on one that machines share."""

import contextlib
import os
import secrets
import shutil
import time
from pathlib import Path

from jobs.disk_folder import ERASED_PREFIX, NEW_PREFIX, DiskFolder
from jobs.store import JobIds, Space, checked_job_id, is_job_id

_ABANDONED_AFTER_S = 3600.0


class DiskStore:
    """The folder of job folders. Made where it is missing, readable by its owner only."""

    def __init__(self, root: Path) -> None:
        self.root = root
        root.mkdir(mode=0o700, parents=True, exist_ok=True)
        self._ids = JobIds()

    def new_id(self) -> str:
        return self._ids.new()

    def folder(self, job_id: str) -> DiskFolder:
        return DiskFolder(self.root, checked_job_id(job_id))

    def ids(self) -> list[str]:
        return sorted(entry.name for entry in os.scandir(self.root) if is_job_id(entry.name))

    def prove(self) -> None:
        """A disk that fails now may do so for want of room only."""

    def trouble(self) -> str | None:
        probe = self.root / f".probe-{secrets.token_hex(6)}"
        try:
            probe.write_bytes(b"x")
        except OSError:
            return "the data folder takes no file"
        finally:
            # A full disk still takes the name of a file, though not its byte.
            with contextlib.suppress(OSError):
                probe.unlink()
        return None

    def space(self) -> Space:
        usage = shutil.disk_usage(self.root)
        return Space(total_bytes=usage.total, free_bytes=usage.free)

    def sweep(self) -> None:
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
