"""Who is let in: a key in a header, held against the key file."""

from collections.abc import Sequence
from dataclasses import dataclass
from datetime import UTC, datetime
from pathlib import Path

from schemas.api_key import KeyState, Scope
from schemas.problem import InternalError, ProblemType
from service.keys.caller import EVERYBODY, Caller
from service.keys.key_file import KeyFile
from service.keys.last_used import LastUsed
from service.keys.refused import KeyRefused, invalid
from service.keys.token import Token

_NO_SECRET_SHA256 = "0" * 64
"""Stands in for an unknown key, which then takes as long to refuse as a wrong secret."""

_SEND = "send a key as `Authorization: Bearer nmri_...`"


@dataclass(frozen=True)
class Gate:
    """require_keys: None asks once a key exists, or where tokens of an issuer will do.

    takes_tokens: whether they will. They are not held against the key file, see service/tokens.
    """

    file: KeyFile
    used: LastUsed
    require_keys: bool | None
    takes_tokens: bool = False

    @classmethod
    def of(cls, data_dir: Path, require_keys: bool | None, *, takes_tokens: bool = False) -> "Gate":
        return cls(KeyFile(data_dir), LastUsed(data_dir), require_keys, takes_tokens)

    def caller(self, presented: Sequence[str]) -> Caller:
        """Who presents these keys, none or one. Raises KeyRefused (401)."""
        known = self._knows_callers()
        if not known and not self.require_keys:
            return EVERYBODY  # whatever was presented is for somebody else, a proxy perhaps
        if not presented and self.require_keys is False:
            return EVERYBODY
        if not presented:
            asked = "an API key, or a token of its issuer" if self.takes_tokens else "an API key"
            raise KeyRefused(
                ProblemType.UNAUTHENTICATED,
                f"this service asks for {asked}. Remedy: {_SEND}; `neuralmri keys create` makes "
                "one.",
                status=401,
            )
        if len(set(presented)) > 1:
            raise invalid("two different keys came with the request. Remedy: send one.")
        caller = self._of_token(Token.parsed(presented[0]))
        if caller.key_id is not None:
            self.used.note(caller.key_id)
        return caller

    def still_admits(self, caller: Caller) -> bool:
        """Whether one who was let in would be now: keys are called back, and tokens end."""
        try:
            if caller.until is not None:
                return datetime.now(tz=UTC) < caller.until
            if caller.key_id is None:
                return self.require_keys is False or not (
                    self.require_keys or self._knows_callers()
                )
            key = self.file.keys().get(caller.key_id)
        except InternalError:
            return False  # a damaged key file lets nobody in
        return key is not None and key.state_at(datetime.now(tz=UTC)) is KeyState.LIVE

    def _knows_callers(self) -> bool:
        return self.takes_tokens or self.file.has_had_keys()

    def _of_token(self, token: Token | None) -> Caller:
        key = self.file.keys().get(token.key_id) if token else None
        secret_sha256 = key.secret_sha256 if key else _NO_SECRET_SHA256
        if token is None or not token.opens(secret_sha256) or key is None:
            raise invalid(
                "this key is not known: it was mistyped or cut short, or never was. Remedy: "
                f"{_SEND}, whole, as it was shown when it was made."
            )
        state = key.state_at(datetime.now(tz=UTC))
        if state is not KeyState.LIVE:
            raise invalid(
                f"key {key.id} is {state}. Remedy: ask whoever runs the service for a new one.",
                key.id,
            )
        return Caller.of_key(key)


def require_scope(caller: Caller, scope: Scope) -> None:
    """Raise KeyRefused (403) where the caller may not do what needs `scope`."""
    if not caller.may(scope):
        held, remedy = "key", f"use a key made with --scope {scope}"
        if caller.subject is not None:
            held, remedy = "token", "ask the issuer for one that has it"
        raise KeyRefused(
            ProblemType.MISSING_SCOPE,
            f"this {held} lacks the scope `{scope}`. Remedy: {remedy}.",
            status=403,
            said=f', error="insufficient_scope", scope="{scope}"',
            actor=caller.actor,
        )
