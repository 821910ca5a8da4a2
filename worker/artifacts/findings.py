"""One suspicion about a reconstruction."""

from dataclasses import dataclass


@dataclass(frozen=True)
class Finding:
    """One suspicion: whether it is grave, how bad beside others of its kind, and in words."""

    grave: bool
    size: float
    text: str
