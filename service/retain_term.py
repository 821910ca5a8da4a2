"""How long a job is kept after its end: as its caller asks, within what the service allows."""

from typing import Annotated

from fastapi import Query

from schemas.problem import InputError, ProblemType
from service.settings import ServiceSettings

_CENTURY_S = 36525 * 86400

RetainS = Annotated[
    int | None,
    Query(
        ge=60,
        le=_CENTURY_S,
        description="Erase the job so many seconds after its end, however it ends. No more than "
        "the service keeps jobs for; left out, that long.",
    ),
]
"""The query parameter `retain_s`."""


def retained_s(asked_s: int | None, settings: ServiceSettings) -> float | None:
    """How long the job is to be kept after its end; None for ever. Raises InputError."""
    days = settings.retention_days
    longest_s = None if days is None else days * 86400.0
    if asked_s is None:
        return longest_s
    if longest_s is not None and asked_s > longest_s:
        raise InputError(
            ProblemType.INVALID_REQUEST,
            f"this service keeps jobs for {longest_s:.0f} s after their end. Remedy: ask for less "
            "in retain_s, or leave it out; fetch the results before they expire.",
            pointer="/query/retain_s",
        )
    return float(asked_s)
