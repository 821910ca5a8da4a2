"""A store that fails, as a problem for callers and a reason for operators.

InternalError
`-- StoreUnavailable  it does not answer, or answers that it cannot: the same may go well later
    `-- StoreMisfit   it will not go well before somebody mends settings, rights or bucket
"""

from schemas.problem import InternalError, ProblemType


class StoreUnavailable(InternalError):  # noqa: N818 - what happened, not "Error"
    """The store of job folders took no step. `reason` is for operators and names no secret."""

    def __init__(self, reason: str) -> None:
        super().__init__(
            ProblemType.STORE_UNAVAILABLE,
            "the job store cannot be reached. Remedy: send the same request again in a while.",
            status=503,
        )
        self.reason = reason

    def __str__(self) -> str:
        return self.reason


class StoreMisfit(StoreUnavailable):
    """The store cannot keep jobs as it is set up."""
