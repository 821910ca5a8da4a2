"""Refusing a number that no phantom, or no scanner, has."""

from schemas.problem import InputError, ProblemType


def require_within(name: str, value: float, low: float, high: float) -> None:
    """Raise InputError (invalid request) where `value` is not in [low, high]."""
    if not low <= value <= high:
        raise InputError(
            ProblemType.INVALID_REQUEST,
            f"{name} = {value:g}; choose between {low:g} and {high:g}.",
            pointer=f"/{name}",
        )
