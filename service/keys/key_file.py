"""`keys.json` in the data folder: the truth about keys, whatever becomes of Redis."""

import os
import secrets
from collections.abc import Callable
from pathlib import Path

from pydantic import ValidationError

from jobs.durable import sync_folder, write_durably
from schemas.api_key import KeyFileContent, StoredKey
from schemas.problem import InternalError, ProblemType
from service.private_files import PRIVATE, give_to_owner_of, held

Keys = dict[str, StoredKey]
"""Keys by id, oldest first."""

_Version = tuple[int, int, int]


class KeyFile:
    """The file, read again whenever it has changed. Any number of processes may change it."""

    def __init__(self, data_dir: Path) -> None:
        self._folder = data_dir
        self._path = data_dir / "keys.json"
        self._read: tuple[_Version, Keys] | None = None
        self._had_keys = False

    def keys(self) -> Keys:
        """Every key, expired and revoked ones too. Raises InternalError for a damaged file."""
        try:
            if self._read is None or self._read[0] != _version(self._path.stat()):
                self._read = self._fresh()
        except FileNotFoundError:
            return {}
        self._had_keys = self._had_keys or bool(self._read[1])
        return self._read[1]

    def has_had_keys(self) -> bool:
        """Whether a key exists, or did while we looked: a file that vanishes opens no door."""
        return bool(self.keys()) or self._had_keys

    def change(self, step: Callable[[Keys], Keys]) -> None:
        """Replace the keys by what `step` makes of them: on disk when this returns, or not at all.

        What `step` raises leaves the file as it was.
        """
        self._folder.mkdir(mode=0o700, parents=True, exist_ok=True)
        with held(self._folder / "keys.lock"):
            content = KeyFileContent(keys=tuple(step(dict(self.keys())).values()))
            draft = self._folder / f".keys-{secrets.token_hex(6)}"
            try:
                write_durably(draft, content.model_dump_json(indent=1).encode(), mode=PRIVATE)
                give_to_owner_of(self._folder, draft)
                draft.rename(self._path)
            finally:
                draft.unlink(missing_ok=True)
            sync_folder(self._folder)

    def _fresh(self) -> tuple[_Version, Keys]:
        with self._path.open("rb") as file:
            version = _version(os.fstat(file.fileno()))
            raw = file.read()
        try:
            content = KeyFileContent.model_validate_json(raw)
        except ValidationError as error:
            raise InternalError(
                ProblemType.INTERNAL,
                "the key file is damaged and nobody is let in. Remedy: put keys.json back from a "
                "backup of the data folder.",
            ) from error
        return version, {key.id: key for key in content.keys}


def _version(stat: os.stat_result) -> _Version:
    # A rename brings a new inode, so two changes within one tick of the clock differ too.
    return stat.st_mtime_ns, stat.st_ino, stat.st_size
