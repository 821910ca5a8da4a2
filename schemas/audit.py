"""One line of the audit log: who did what to which job, when, and what came of it."""

from datetime import datetime
from enum import StrEnum

from schemas.api_key import KeyId
from schemas.base import Name, WireModel


class Action(StrEnum):
    """What was done, or tried."""

    SUBMIT = "submit"
    CANCEL = "cancel"
    ERASE = "erase"
    DOWNLOAD = "download"
    """A report or a file of results was fetched."""
    READ = "read"
    """Any other look at a job; written only where it was refused."""
    KEY_CREATED = "key-created"
    KEY_ROTATED = "key-rotated"
    KEY_REVOKED = "key-revoked"


class AuditOutcome(StrEnum):
    """What came of it."""

    DONE = "done"
    REFUSED = "refused"
    """No key, a wrong one, one without the scope, or a job that is not this caller's."""
    FAILED = "failed"
    """Something else: a bad request, or a fault of the service."""


class AuditEntry(WireModel):
    """No name of a subject, no address of a caller, no secret is in it.

    actor: the id of the key that came with the request, if its secret was right; `anonymous` where
    none was asked for, `unknown` where none or a wrong one came, `operator` for the command line,
    `retention` for what erases jobs that have expired.
    key: the one that a `key-...` action is about. status: of the HTTP answer.
    ended_at, expires_at: of a job that was erased because it had expired.
    """

    at: datetime
    actor: KeyId | Name
    owner: Name | None = None
    action: Action
    outcome: AuditOutcome
    job: str | None = None
    key: KeyId | None = None
    status: int | None = None
    ended_at: datetime | None = None
    expires_at: datetime | None = None
