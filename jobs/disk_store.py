"""Job folders under one root on a disk of this machine, or on one that machines share."""

import contextlib
import os
import secrets
import shutil
import time
from collections.abc import Collection
from pathlib import Path

from jobs.disk_folder import ERASED_PREFIX, NEW_PREFIX, DiskFolder
from jobs.quarantine import Quarantine
from jobs.setting_aside import set_aside
from jobs.store import JobIds, Space, checked_job_id, is_job_id

_ABANDONED_AFTER_S = 3600.0
_NO_JOBS = ("lost+found",)


class DiskStore:
    """The folder of job folders. Made where it is missing, readable by its owner only."""

    def __init__(self, root: Path) -> None:
        self.root = root
        root.mkdir(mode=0o700, parents=True, exist_ok=True)
        self._ids = JobIds()
        self._first_seen_s: dict[str, float] = {}

    def new_id(self) -> str:
        return self._ids.new()

    def folder(self, job_id: str) -> DiskFolder:
        return DiskFolder(self.root, checked_job_id(job_id))

    def ids(self) -> list[str]:
        return sorted(entry.name for entry in os.scandir(self.root) if is_job_id(entry.name))

    def gone(self, job_ids: Collection[str]) -> set[str]:
        return {job_id for job_id in job_ids if not self.folder(job_id).exists()}

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

    def set_aside(self, suspects: Collection[str]) -> tuple[str, ...]:
        folders = [self.folder(job_id) for job_id in sorted(suspects)]
        return set_aside(Quarantine(self.root), self.strangers(), folders)

    def quarantined(self) -> int:
        return Quarantine(self.root).count()

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
