"""An issuer's public keys, as it publishes them (RFC 7517), and which one a token was signed by."""

from collections.abc import Mapping, Sequence
from dataclasses import dataclass
from typing import Any

from jwt import PyJWK
from jwt.exceptions import PyJWTError

_KINDS = {"RS": "RSA", "PS": "RSA", "ES": "EC", "Ed": "OKP"}
_MAX_KEYS = 100


@dataclass(frozen=True)
class KeySet:
    """The set as it came; each key is read for the algorithm that it is asked for."""

    keys: Sequence[Mapping[str, Any]]

    @classmethod
    def of_document(cls, document: Any) -> "KeySet":
        """Raises ValueError for what is no key set, or has none for signatures."""
        listed = document.get("keys") if isinstance(document, dict) else None
        if not isinstance(listed, list):
            raise ValueError("it is no JSON Web Key Set")
        keys = [key for key in listed[:_MAX_KEYS] if isinstance(key, dict) and _signs(key)]
        if not keys:
            raise ValueError("it has no key for signatures")
        return cls(keys)

    def key(self, kid: str | None, algorithm: str) -> PyJWK | None:
        """The key that a token's header names; None where the set has none that fits.

        A header may leave the name out where only one key can be meant (OpenID Connect Core, 10.1).
        """
        fitting = [
            key
            for key in self.keys
            if key.get("kty") == _KINDS[algorithm[:2]]
            and key.get("alg", algorithm) == algorithm
            and (kid is None or key.get("kid") == kid)
        ]
        if len(fitting) != 1:
            return None
        try:
            return PyJWK(dict(fitting[0]), algorithm)
        except PyJWTError:
            return None


def _signs(key: Mapping[str, Any]) -> bool:
    operations = key.get("key_ops", ["verify"])
    return (
        key.get("use", "sig") == "sig" and isinstance(operations, list) and "verify" in operations
    )
