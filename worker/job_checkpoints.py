"""Checkpoints of a job in its folder, each under the fingerprint of what it is a state of.

One that is damaged, or of another input, code or machine, is as good as none. Any attempt of the
job goes through the very same states, so one that was overtaken and writes last sets the next one
back by some levels, never astray; and it stops writing as soon as it knows.
"""

import hashlib
import logging
from collections.abc import Callable

from jobs.folder import JobFolder
from jobs.store_errors import StoreUnavailable

_LOGGER = logging.getLogger(__name__)
_FORM = b"neuralmri checkpoint 1\n"
_DIGEST_BYTES = hashlib.sha256().digest_size


class JobCheckpoints:
    """`worker.checkpoints.Checkpoints`, kept for the next attempt on a job."""

    def __init__(
        self, folder: JobFolder, fingerprint: str, is_told_to_stop: Callable[[], bool]
    ) -> None:
        """fingerprint: of all that decides the result. is_told_to_stop: whether this attempt has
        nothing more to say, because the job is another's or is being cancelled.
        """
        self._folder = folder
        self._fingerprint = fingerprint
        self._is_told_to_stop = is_told_to_stop
        self._has_warned = False

    def load(self, key: str) -> bytes | None:
        try:
            held = self._folder.read_checkpoint(key)
        except (OSError, StoreUnavailable) as error:
            _LOGGER.warning("checkpoint %s cannot be read, it is done anew: %s", key, error)
            return None
        if held is None:
            return None
        head, content = self._head(key), held[len(_FORM) + 2 * _DIGEST_BYTES :]
        if not held.startswith(head):
            _LOGGER.warning(
                "checkpoint %s is of another input, code or machine, or damaged: it is done anew",
                key,
            )
            return None
        if held[len(head) : len(head) + _DIGEST_BYTES] != hashlib.sha256(content).digest():
            _LOGGER.warning("checkpoint %s is damaged: it is done anew", key)
            return None
        _LOGGER.info("checkpoint %s is taken up", key)
        return content

    def save(self, key: str, content: bytes) -> None:
        """Raises JobGone where the job was erased. A store that fails costs the checkpoint only."""
        if self._is_told_to_stop():
            return
        held = self._head(key) + hashlib.sha256(content).digest() + content
        try:
            self._folder.write_checkpoint(key, held)
        except (OSError, StoreUnavailable) as error:
            if not self._has_warned:
                _LOGGER.warning("no checkpoint is kept, the job goes on without: %s", error)
            self._has_warned = True

    def _head(self, key: str) -> bytes:
        """What a checkpoint of this key begins with."""
        return _FORM + hashlib.sha256(f"{key}\n{self._fingerprint}".encode()).digest()
