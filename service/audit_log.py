"""The audit log: JSON lines in `audit/` of the data folder, in two files.

    done.jsonl      what was done
    refused.jsonl   what was refused, or failed

Apart, so that whoever floods the service with requests that are refused cannot push the proof of an
erasure out of the log. A file that has grown to its size becomes `done.1.jsonl`, `done.1.jsonl`
becomes `done.2.jsonl`, and the oldest goes. Any number of processes may write.
"""

import os
from dataclasses import dataclass
from pathlib import Path

from jobs.durable import sync_folder
from schemas.audit import Action, AuditEntry, AuditOutcome
from service.private_files import give_to_owner_of, held, open_private
from service.settings import ServiceSettings

_FSYNCED = (Action.ERASE, Action.KEY_CREATED, Action.KEY_ROTATED, Action.KEY_REVOKED)


@dataclass(frozen=True)
class AuditLog:
    """max_bytes: of one file. kept_files: of each kind, the one that is written among them."""

    folder: Path
    max_bytes: int
    kept_files: int

    @classmethod
    def of_settings(cls, settings: ServiceSettings) -> "AuditLog":
        return cls(settings.data_dir / "audit", settings.audit_max_bytes, settings.audit_files)

    def write(self, entry: AuditEntry) -> None:
        """Append a line; what erased a job or touched a key is on disk when this returns."""
        name = "done" if entry.outcome is AuditOutcome.DONE else "refused"
        line = entry.model_dump_json(exclude_none=True).encode() + b"\n"
        if not self.folder.is_dir():
            self.folder.mkdir(mode=0o700, parents=True, exist_ok=True)
            give_to_owner_of(self.folder.parent, self.folder)
        with held(self.folder / "lock"):
            path = self.folder / f"{name}.jsonl"
            if path.exists() and path.stat().st_size + len(line) > self.max_bytes:
                self._rotate(name)
            is_new = not path.exists()
            descriptor = open_private(path, os.O_WRONLY | os.O_APPEND)
            try:
                _write_whole(descriptor, line)
                if entry.action in _FSYNCED and name == "done":
                    os.fsync(descriptor)
            finally:
                os.close(descriptor)
            if is_new:
                sync_folder(self.folder)

    def _rotate(self, name: str) -> None:
        numbered = [self.folder / f"{name}.jsonl"] + [
            self.folder / f"{name}.{number}.jsonl" for number in range(1, self.kept_files)
        ]
        numbered[-1].unlink(missing_ok=True)
        for newer, older in zip(numbered[-2::-1], numbered[:0:-1], strict=True):
            if newer.exists():
                newer.rename(older)
        sync_folder(self.folder)


def _write_whole(descriptor: int, line: bytes) -> None:
    """All of the line, or none of it: a full disk leaves no half line for the next to continue."""
    before = os.fstat(descriptor).st_size
    try:
        written = os.write(descriptor, line)
        if written < len(line):
            os.write(descriptor, line[written:])
    except OSError:
        os.ftruncate(descriptor, before)
        raise
