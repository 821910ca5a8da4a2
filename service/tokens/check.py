"""Who sends a token: RFC 9068 and OpenID Connect Core, as far as they say what to check."""

from datetime import UTC, datetime, timedelta
from typing import Any

import jwt
from jwt.exceptions import (
    ExpiredSignatureError,
    InvalidAudienceError,
    InvalidIssuerError,
    PyJWTError,
)

from schemas.api_key import Scope
from service.keys.caller import Caller
from service.keys.refused import invalid
from service.tokens.keys_at_hand import KeysAtHand
from service.tokens.opaque_id import opaque_id
from service.tokens.settings import OidcSettings, parse_scopes

_REQUIRED = ["exp", "iss", "aud", "sub"]
_MAX_LENGTH = 16_384
_GET_ANOTHER = "Remedy: get a new token from the issuer."


class TokenCheck:
    """Says for whom a token stands, or that it stands for nobody."""

    def __init__(self, settings: OidcSettings, keys: KeysAtHand) -> None:
        self._settings = settings
        self._keys = keys
        self._algorithms = settings.oidc_algorithms.split()
        self._scopes = parse_scopes(settings.oidc_scopes)

    async def caller(self, token: str) -> Caller:
        """The caller whom the token names.

        Raises KeyRefused (401) for one that is not good, and InternalError (503) where that cannot
        be told now. No message repeats anything of the token.
        """
        kid, algorithm = self._header(token)
        key = await self._keys.key(kid, algorithm)
        if key is None:
            raise invalid(f"the token is signed by no key of its issuer's. {_GET_ANOTHER}")
        return self._of_claims(self._claims(token, key, algorithm))

    def _header(self, token: str) -> tuple[str | None, str]:
        """Key and algorithm that the header names; the algorithm is one that counts."""
        try:
            # Nothing that is read before the signature is believed: it only says where to look.
            header = jwt.get_unverified_header(token) if len(token) <= _MAX_LENGTH else {}
        except PyJWTError as error:
            raise invalid(f"this is neither a key nor a whole token. {_GET_ANOTHER}") from error
        algorithm = header.get("alg")
        if algorithm not in self._algorithms:
            raise invalid(
                "the token is not signed as this service has it "
                f"({', '.join(self._algorithms)}). {_GET_ANOTHER}"
            )
        return header.get("kid"), algorithm

    def _claims(self, token: str, key: jwt.PyJWK, algorithm: str) -> dict[str, Any]:
        try:
            return jwt.decode(
                token,
                key,
                algorithms=[algorithm],
                audience=self._settings.oidc_audience,
                issuer=self._settings.oidc_issuer,
                leeway=self._settings.oidc_leeway_s,
                options={"require": _REQUIRED, "enforce_minimum_key_length": True},
            )
        except ExpiredSignatureError as error:
            raise invalid(f"the token has expired. {_GET_ANOTHER}") from error
        except InvalidAudienceError as error:
            raise invalid(
                "the token is for another service. Remedy: ask the issuer for one whose audience "
                "is this service."
            ) from error
        except InvalidIssuerError as error:
            raise invalid(f"the token is of another issuer. {_GET_ANOTHER}") from error
        except (PyJWTError, ValueError, TypeError, OverflowError) as error:
            raise invalid(
                f"the token is not good ({type(error).__name__}). {_GET_ANOTHER}"
            ) from error

    def _of_claims(self, claims: dict[str, Any]) -> Caller:
        issuer, claim = claims["iss"], self._settings.oidc_owner_claim
        subject, owner = claims["sub"], claims.get(claim)
        if not (isinstance(owner, str) and owner and subject):
            raise invalid(
                f"the token does not say whose it is: its claim {claim!r} is no text. Remedy: have "
                "the issuer put it into tokens for this service."
            )
        return Caller(
            owner=opaque_id(issuer, claim, owner),
            scopes=frozenset(self._granted(claims.get(self._settings.oidc_scope_claim))),
            subject=opaque_id(issuer, "sub", subject),
            until=_instant(claims["exp"]) + timedelta(seconds=self._settings.oidc_leeway_s),
        )

    def _granted(self, claim: Any) -> set[Scope]:
        """Scopes of a claim: words in one text (RFC 8693), or a list of them, as some write it."""
        words = claim.split() if isinstance(claim, str) else claim
        if not isinstance(words, list):
            return set()
        return {
            self._scopes[word] for word in words if isinstance(word, str) and word in self._scopes
        }


def _instant(seconds: float) -> datetime:
    latest = datetime.max.replace(tzinfo=UTC) - timedelta(days=1)
    return datetime.fromtimestamp(min(int(seconds), int(latest.timestamp())), tz=UTC)
