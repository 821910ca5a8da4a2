"""API keys as they are kept, listed, and shown once."""

from datetime import datetime
from enum import StrEnum
from typing import Annotated

from pydantic import Field, StringConstraints

from schemas.base import Name, WireModel

KEY_ID_PATTERN = r"^[0-9a-f]{16}$"

KeyId = Annotated[str, StringConstraints(pattern=KEY_ID_PATTERN)]
Label = Annotated[str, StringConstraints(pattern=r"^[^\x00-\x1f\x7f]{1,64}$")]


class Scope(StrEnum):
    """What a key may be used for."""

    READ = "read"
    """Look at jobs, fetch their results, read the metrics."""
    SUBMIT = "submit"
    """Submit, cancel and erase jobs. Does not include `read`."""
    ADMIN = "admin"
    """All of that, with the jobs of every owner."""


class KeyState(StrEnum):
    """Whether a key opens anything."""

    LIVE = "live"
    EXPIRED = "expired"
    REVOKED = "revoked"


class ApiKey(WireModel):
    """One key, without its secret.

    owner: whose jobs it works on. expires_at: None for never. replaced_by: the key that it was
    exchanged for.
    """

    id: KeyId
    label: Label
    owner: Name
    scopes: tuple[Scope, ...] = Field(min_length=1)
    created_at: datetime
    expires_at: datetime | None = None
    revoked_at: datetime | None = None
    replaced_by: KeyId | None = None

    def state_at(self, now: datetime) -> KeyState:
        if self.revoked_at is not None:
            return KeyState.REVOKED
        if self.expires_at is not None and self.expires_at <= now:
            return KeyState.EXPIRED
        return KeyState.LIVE


class StoredKey(ApiKey):
    """A key as the key file has it: of the secret, only what cannot be turned back into it."""

    secret_sha256: Annotated[str, StringConstraints(pattern=r"^[0-9a-f]{64}$")]

    def without_secret(self) -> ApiKey:
        return ApiKey.model_validate(self.model_dump(exclude={"secret_sha256"}))


class KeyFileContent(WireModel):
    """The key file."""

    keys: tuple[StoredKey, ...] = ()


class MadeKey(WireModel):
    """What is said of a new key, once: `token` is nowhere else."""

    key: ApiKey
    token: str


class ListedKey(WireModel):
    """A key, whether it is good for anything, and when it last was."""

    key: ApiKey
    state: KeyState
    last_used_at: datetime | None = None
