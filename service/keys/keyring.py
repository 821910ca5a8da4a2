"""What is done to keys: made, exchanged, called back."""

from datetime import UTC, datetime, timedelta

from schemas.api_key import ApiKey, KeyState, Scope, StoredKey
from schemas.problem import InputError, ProblemType
from service.keys.key_file import KeyFile, Keys
from service.keys.token import Token


def create(
    file: KeyFile, label: str, owner: str, scopes: tuple[Scope, ...], lifetime: timedelta | None
) -> tuple[ApiKey, Token]:
    """A new key, good for `lifetime` (None: for ever), and the token that nothing keeps."""
    now = _now()
    token = Token.new()
    key = StoredKey(
        id=token.key_id,
        label=label,
        owner=owner,
        scopes=tuple(dict.fromkeys(scopes)),
        created_at=now,
        expires_at=now + lifetime if lifetime else None,
        secret_sha256=token.sha256,
    )
    file.change(lambda keys: {**keys, key.id: key})
    return key.without_secret(), token


def revoke(file: KeyFile, key_id: str) -> ApiKey:
    """The key opens nothing from now on. Doing it again changes nothing. Raises InputError."""
    now = _now()

    def step(keys: Keys) -> Keys:
        key = _known(keys, key_id)
        revoked = key.model_copy(update={"revoked_at": key.revoked_at or now})
        return {**keys, key_id: revoked}

    file.change(step)
    return file.keys()[key_id].without_secret()


def rotate(file: KeyFile, key_id: str, overlap: timedelta) -> tuple[ApiKey, Token]:
    """A key in the place of another: same label, owner and scopes, as long a life from now.

    The old one goes on for `overlap`, or to its own end where that is sooner. Raises InputError
    for a key that is not known or opens nothing any more.
    """
    now = _now()
    token = Token.new()

    def step(keys: Keys) -> Keys:
        old = _known(keys, key_id)
        _check_rotatable(old, now)
        lifetime = old.expires_at - old.created_at if old.expires_at else None
        new = old.model_copy(
            update={
                "id": token.key_id,
                "created_at": now,
                "expires_at": now + lifetime if lifetime else None,
                "secret_sha256": token.sha256,
            }
        )
        ends = min(filter(None, (old.expires_at, now + overlap)))
        ending = old.model_copy(update={"expires_at": ends, "replaced_by": new.id})
        return {**keys, key_id: ending, new.id: new}

    file.change(step)
    return file.keys()[token.key_id].without_secret(), token


def _known(keys: Keys, key_id: str) -> StoredKey:
    if key_id not in keys:
        raise InputError(
            ProblemType.NOT_FOUND,
            "there is no key of this id. Remedy: take the id from `neuralmri keys list`.",
            status=404,
        )
    return keys[key_id]


def _check_rotatable(key: StoredKey, now: datetime) -> None:
    if (state := key.state_at(now)) is not KeyState.LIVE:
        raise InputError(
            ProblemType.INVALID_REQUEST,
            f"key {key.id} is {state}. Remedy: create a new one of the same owner "
            f"(--owner {key.owner}).",
        )
    if key.replaced_by is not None:
        raise InputError(
            ProblemType.INVALID_REQUEST,
            f"key {key.id} has been rotated. Remedy: rotate the key in its place, "
            f"{key.replaced_by}.",
        )


def _now() -> datetime:
    return datetime.now(tz=UTC)
