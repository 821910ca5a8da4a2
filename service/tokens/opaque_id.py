"""What we call those whom tokens name."""

import hashlib

OWNER_PREFIX = "oidc-"
"""Of every owner who comes by a token, and of none who comes by a key."""


def opaque_id(issuer: str, claim: str, value: str) -> str:
    """The same name for the same value of a claim, from which the value is not to be read.

    A `sub` may be an address or a person's name, which no log and no folder should hold.
    """
    digest = hashlib.sha256(f"{issuer}\n{claim}\n{value}".encode())
    return OWNER_PREFIX + digest.hexdigest()[:32]
