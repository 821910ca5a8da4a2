"""That a request is not let in, and what it is told."""

from schemas.problem import InputError, ProblemType


class KeyRefused(InputError):  # noqa: N818 - reads as what happened
    """The request is not let in.

    challenge: the value of WWW-Authenticate (RFC 6750).
    actor: whose key or token it was, where its secret or signature was right.
    """

    def __init__(
        self,
        type_: ProblemType,
        detail: str,
        *,
        status: int,
        said: str = "",
        actor: str | None = None,
    ) -> None:
        super().__init__(type_, detail, status=status)
        self.challenge = 'Bearer realm="neuralmri"' + said
        self.actor = actor


def invalid(detail: str, actor: str | None = None) -> KeyRefused:
    """For a key or token that is not good."""
    return KeyRefused(
        ProblemType.UNAUTHENTICATED,
        detail,
        status=401,
        said=', error="invalid_token"',
        actor=actor,
    )
