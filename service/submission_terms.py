"""What comes with a submission beside its body."""

from typing import Annotated

from fastapi import Depends, Query

from schemas.job import Priority

_PRIORITY = (
    "Which jobs go first: a free worker takes an `interactive` job before any `batch` job, and of "
    "one priority the oldest. While interactive jobs keep coming, a batch job has its turn from "
    "time to time."
)


class SubmissionTerms:
    """How a request wants to be treated, as its parameters say."""

    def __init__(
        self,
        priority: Annotated[Priority, Query(description=_PRIORITY)] = Priority.INTERACTIVE,
    ) -> None:
        self.priority = priority


Terms = Annotated[SubmissionTerms, Depends()]
