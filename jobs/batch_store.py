"""The records of batches on disk: `<root>/<batch id>.json`, whole or not there."""

import hashlib
import os
import re
import secrets
import time
from pathlib import Path

from jobs.durable import sync_folder, write_durably

BATCH_ID_PATTERN = r"^bt_[0-9a-f]{32}$"

_BATCH_ID = re.compile(BATCH_ID_PATTERN)
_TAIL_DIGITS = 20
_DRAFT = ".draft-"
_ABANDONED_AFTER_S = 3600.0


def is_batch_id(text: str) -> bool:
    """Whether the text may name a batch: to be asked before it touches a path."""
    return _BATCH_ID.fullmatch(text) is not None


def batch_tail(owner: str, key: str | None) -> str:
    """The last 20 digits of a batch's id: of an owner's idempotency key, or drawn without one.

    So the names alone say which batch was made under a key, and no index has to be kept.
    """
    if key is None:
        return secrets.token_hex(_TAIL_DIGITS // 2)
    return hashlib.sha256(f"{owner}\0{key}".encode()).hexdigest()[:_TAIL_DIGITS]


def new_batch_id(tail: str) -> str:
    """Unix time in ms, then the tail: ids sort by the time they were made."""
    return f"bt_{time.time_ns() // 1_000_000:012x}{tail}"


class BatchStore:
    """Records by id, bytes in and out. The folder is made where it is missing."""

    def __init__(self, root: Path) -> None:
        self._root = root
        root.mkdir(mode=0o700, parents=True, exist_ok=True)
        self._sweep()

    def write(self, batch_id: str, content: bytes) -> None:
        """Store a record, in place of the one that is there; it is on the disk then."""
        draft = self._root / f"{_DRAFT}{os.getpid()}-{secrets.token_hex(6)}"
        try:
            write_durably(draft, content, mode=0o600)
            draft.replace(self._path(batch_id))
        finally:
            draft.unlink(missing_ok=True)
        sync_folder(self._root)

    def read(self, batch_id: str) -> bytes | None:
        """The record; None where there is none."""
        try:
            return self._path(batch_id).read_bytes()
        except FileNotFoundError:
            return None

    def ids(self) -> list[str]:
        """Of every batch, oldest first."""
        stems = (Path(entry.name).stem for entry in os.scandir(self._root))
        return sorted(stem for stem in stems if is_batch_id(stem))

    def erase(self, batch_id: str) -> None:
        """Remove a record. Nothing happens where there is none."""
        self._path(batch_id).unlink(missing_ok=True)
        sync_folder(self._root)

    def _sweep(self) -> None:
        """Remove drafts of processes that died while they wrote, an hour ago or more."""
        oldest = time.time() - _ABANDONED_AFTER_S
        for draft in self._root.glob(f"{_DRAFT}*"):
            try:
                if draft.stat().st_mtime < oldest:
                    draft.unlink()
            except FileNotFoundError:
                continue  # another process was faster

    def _path(self, batch_id: str) -> Path:
        if not is_batch_id(batch_id):
            raise ValueError("not a batch id: bt_ and 32 hexadecimal digits are")
        return self._root / f"{batch_id}.json"
