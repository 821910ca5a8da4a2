"""Who a request comes from, and what that one may do."""

from dataclasses import dataclass
from datetime import datetime

from jobs.index import ANY_OWNER
from schemas.api_key import ApiKey, Scope
from schemas.messages import ANONYMOUS


@dataclass(frozen=True)
class Caller:
    """owner: whose jobs the caller works on. key_id: None without a key.

    subject: whom the issuer's token names, in our own words for it; None without a token.
    until: when the token ends.
    """

    owner: str
    scopes: frozenset[Scope] = frozenset()
    key_id: str | None = None
    subject: str | None = None
    until: datetime | None = None

    @classmethod
    def of_key(cls, key: ApiKey) -> "Caller":
        return cls(key.owner, frozenset(key.scopes), key.id)

    @property
    def actor(self) -> str:
        """As the audit log has it."""
        return self.key_id or self.subject or self.owner

    @property
    def is_named(self) -> bool:
        """Whether a key or a token says who it is."""
        return self.key_id is not None or self.subject is not None

    @property
    def is_admin(self) -> bool:
        return Scope.ADMIN in self.scopes

    @property
    def listed_owner(self) -> str:
        """Whose jobs a list shows."""
        return ANY_OWNER if self.is_admin else self.owner

    def may(self, scope: Scope) -> bool:
        return scope in self.scopes or self.is_admin

    def sees(self, owner: str) -> bool:
        """Whether jobs of `owner` are there at all, as far as this caller is told."""
        return bool(self.scopes) and self.listed_owner in (owner, ANY_OWNER)


EVERYBODY = Caller(ANONYMOUS, frozenset({Scope.READ, Scope.SUBMIT}))
"""Whoever calls a service that asks for no keys."""

NOBODY = Caller(ANONYMOUS)
"""Whom nothing has let in: sees no job."""
