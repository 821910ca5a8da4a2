"""What a caller sends: `nmri_<id>_<secret>`, and how a secret is held against what is kept of it.

The secret has 256 random bits, so a plain SHA-256 of it is enough to keep: there is no password to
guess that a slow hash would have to protect.
"""

import hashlib
import hmac
import re
import secrets
from dataclasses import dataclass, field

PREFIX = "nmri_"
"""Of every key, and of no token of an issuer: those begin with JSON in base64."""

_FORM = re.compile(PREFIX + r"([0-9a-f]{16})_([0-9a-f]{64})")
_ID_BYTES = 8
_SECRET_BYTES = 32


@dataclass(frozen=True)
class Token:
    """A key's id and its secret. The secret is in no representation of it."""

    key_id: str
    secret: str = field(repr=False)

    @classmethod
    def new(cls) -> "Token":
        return cls(secrets.token_hex(_ID_BYTES), secrets.token_hex(_SECRET_BYTES))

    @classmethod
    def parsed(cls, text: str) -> "Token | None":
        """The token in a header; None for anything else, of whatever length."""
        found = _FORM.fullmatch(text)
        return cls(found[1], found[2]) if found else None

    @property
    def text(self) -> str:
        return f"{PREFIX}{self.key_id}_{self.secret}"

    @property
    def sha256(self) -> str:
        """What is kept of the secret."""
        return hashlib.sha256(self.secret.encode()).hexdigest()

    def opens(self, secret_sha256: str) -> bool:
        """Whether this is the secret, in a time that does not tell how much of it is right."""
        return hmac.compare_digest(self.sha256, secret_sha256)
