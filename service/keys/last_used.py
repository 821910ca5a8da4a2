"""When each key was last used, to the minute: `keys-used.json` in the data folder.

A hint for who tidies up, so a power cut may cost the newest minutes; it is not fsynced.
"""

import logging
import secrets
from datetime import UTC, datetime, timedelta
from pathlib import Path

from pydantic import TypeAdapter

from service.private_files import PRIVATE, give_to_owner_of, held

_LOGGER = logging.getLogger("neuralmri.keys")
_TIMES = TypeAdapter(dict[str, datetime])
_EVERY = timedelta(minutes=1)


class LastUsed:
    """Times by key id. Any number of processes may note them."""

    def __init__(self, data_dir: Path) -> None:
        self._folder = data_dir
        self._path = data_dir / "keys-used.json"
        self._noted: dict[str, datetime] = {}

    def times(self) -> dict[str, datetime]:
        try:
            return _TIMES.validate_json(self._path.read_bytes())
        except FileNotFoundError:
            return {}

    def note(self, key_id: str) -> None:
        """The key was used now. A disk that takes no file costs the note, never the request."""
        now = datetime.now(tz=UTC)
        if key_id in self._noted and now - self._noted[key_id] < _EVERY:
            return
        self._noted[key_id] = now
        try:
            self._write(key_id, now)
        except (OSError, ValueError) as error:
            _LOGGER.warning("the last use of key %s was not noted: %r", key_id, error)

    def _write(self, key_id: str, now: datetime) -> None:
        with held(self._folder / "keys.lock"):
            draft = self._folder / f".keys-used-{secrets.token_hex(6)}"
            try:
                draft.touch(mode=PRIVATE)
                draft.write_bytes(_TIMES.dump_json({**self.times(), key_id: now}))
                give_to_owner_of(self._folder, draft)
                draft.rename(self._path)
            finally:
                draft.unlink(missing_ok=True)
