"""Where who runs the service makes keys and calls them back; every step is in the audit log."""

import re
from datetime import UTC, datetime, timedelta

from schemas.api_key import ApiKey, ListedKey, MadeKey, Scope
from schemas.audit import Action, AuditEntry, AuditOutcome
from schemas.problem import InputError, ProblemType
from service.audit_log import AuditLog
from service.keys import keyring
from service.keys.key_file import KeyFile
from service.keys.last_used import LastUsed
from service.settings import ServiceSettings
from service.tokens.opaque_id import OWNER_PREFIX

OPERATOR = "operator"

_NAME = re.compile(r"[A-Za-z0-9._-]{1,64}")
_PRINTABLE = re.compile(r"[^\x00-\x1f\x7f]{1,64}")


class KeyDesk:
    """The keys of one data folder. Every method raises InputError, OSError."""

    def __init__(self, settings: ServiceSettings) -> None:
        self._file = KeyFile(settings.data_dir)
        self._used = LastUsed(settings.data_dir)
        self._log = AuditLog.of_settings(settings)

    def create(
        self, label: str, owner: str | None, scopes: tuple[Scope, ...], lifetime: timedelta | None
    ) -> MadeKey:
        """A new key; without an owner, of the one whom its label names."""
        if not _PRINTABLE.fullmatch(label):
            raise _unfit("label", "1 to 64 characters, none of them a control character")
        owner = owner or label
        if not _NAME.fullmatch(owner):
            raise _unfit("owner", "1 to 64 of letters, digits, dot, underscore and hyphen")
        if owner.startswith(OWNER_PREFIX):
            raise _unfit("owner", f"no name that begins with {OWNER_PREFIX}: tokens bring those")
        if not scopes:
            raise _unfit("scope", "at least one of read, submit, admin")
        key, token = keyring.create(self._file, label, owner, scopes, lifetime)
        self._note(Action.KEY_CREATED, key)
        return MadeKey(key=key, token=token.text)

    def rotate(self, key_id: str, overlap: timedelta) -> MadeKey:
        """A new key in the place of one that goes on for `overlap`."""
        key, token = keyring.rotate(self._file, key_id, overlap)
        self._note(Action.KEY_ROTATED, self._file.keys()[key_id])
        self._note(Action.KEY_CREATED, key)
        return MadeKey(key=key, token=token.text)

    def revoke(self, key_id: str) -> ListedKey:
        key = keyring.revoke(self._file, key_id)
        self._note(Action.KEY_REVOKED, key)
        return self._listed(key)

    def listed(self) -> list[ListedKey]:
        """Every key, the oldest first."""
        return [self._listed(key.without_secret()) for key in self._file.keys().values()]

    def _listed(self, key: ApiKey) -> ListedKey:
        now = datetime.now(tz=UTC)
        return ListedKey(
            key=key, state=key.state_at(now), last_used_at=self._used.times().get(key.id)
        )

    def _note(self, action: Action, key: ApiKey) -> None:
        self._log.write(
            AuditEntry(
                at=datetime.now(tz=UTC),
                actor=OPERATOR,
                owner=key.owner,
                action=action,
                outcome=AuditOutcome.DONE,
                key=key.id,
            )
        )


def _unfit(what: str, should_be: str) -> InputError:
    return InputError(
        ProblemType.INVALID_REQUEST, f"a key's {what} is {should_be}. Remedy: give it with --{what}"
    )
