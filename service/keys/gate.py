"""Who is let in: a key in a header, held against the key file."""

from collections.abc import Sequence
from dataclasses import dataclass
from datetime import UTC, datetime
from pathlib import Path

from schemas.api_key import KeyState, Scope
from schemas.problem import InputError, ProblemType
from service.keys.caller import EVERYBODY, Caller
from service.keys.key_file import KeyFile
from service.keys.last_used import LastUsed
from service.keys.token import Token

_NO_SECRET_SHA256 = "0" * 64
"""Stands in for an unknown key, which then takes as long to refuse as a wrong secret."""

_SEND = "send a key as `Authorization: Bearer nmri_...`"


class KeyRefused(InputError):  # noqa: N818 - reads as what happened
    """The request is not let in.

    challenge: the value of WWW-Authenticate (RFC 6750).
    key_id: the key, where its secret was right.
    """

    def __init__(
        self,
        type_: ProblemType,
        detail: str,
        *,
        status: int,
        said: str = "",
        key_id: str | None = None,
    ) -> None:
        super().__init__(type_, detail, status=status)
        self.challenge = 'Bearer realm="neuralmri"' + said
        self.key_id = key_id


@dataclass(frozen=True)
class Gate:
    """require_keys: None asks for keys once one exists."""

    file: KeyFile
    used: LastUsed
    require_keys: bool | None

    @classmethod
    def of(cls, data_dir: Path, require_keys: bool | None) -> "Gate":
        return cls(KeyFile(data_dir), LastUsed(data_dir), require_keys)

    def caller(self, presented: Sequence[str]) -> Caller:
        """Who presents these keys, none or one. Raises KeyRefused (401)."""
        known = self.file.has_had_keys()
        if not known and not self.require_keys:
            return EVERYBODY  # whatever was presented is for somebody else, a proxy perhaps
        if not presented and self.require_keys is False:
            return EVERYBODY
        if not presented:
            raise KeyRefused(
                ProblemType.UNAUTHENTICATED,
                f"this service asks for an API key. Remedy: {_SEND}; `neuralmri keys create` makes "
                "one.",
                status=401,
            )
        if len(set(presented)) > 1:
            raise _invalid("two different keys came with the request. Remedy: send one.")
        caller = self._of_token(Token.parsed(presented[0]))
        if caller.key_id is not None:
            self.used.note(caller.key_id)
        return caller

    def _of_token(self, token: Token | None) -> Caller:
        key = self.file.keys().get(token.key_id) if token else None
        secret_sha256 = key.secret_sha256 if key else _NO_SECRET_SHA256
        if token is None or not token.opens(secret_sha256) or key is None:
            raise _invalid(
                "this key is not known: it was mistyped or cut short, or never was. Remedy: "
                f"{_SEND}, whole, as it was shown when it was made."
            )
        state = key.state_at(datetime.now(tz=UTC))
        if state is not KeyState.LIVE:
            raise _invalid(
                f"key {key.id} is {state}. Remedy: ask whoever runs the service for a new one.",
                key.id,
            )
        return Caller.of_key(key)


def require_scope(caller: Caller, scope: Scope) -> None:
    """Raise KeyRefused (403) where the caller may not do what needs `scope`."""
    if not caller.may(scope):
        raise KeyRefused(
            ProblemType.MISSING_SCOPE,
            f"this key lacks the scope `{scope}`. Remedy: use a key made with --scope {scope}.",
            status=403,
            said=f', error="insufficient_scope", scope="{scope}"',
            key_id=caller.key_id,
        )


def _invalid(detail: str, key_id: str | None = None) -> KeyRefused:
    return KeyRefused(
        ProblemType.UNAUTHENTICATED,
        detail,
        status=401,
        said=', error="invalid_token"',
        key_id=key_id,
    )
