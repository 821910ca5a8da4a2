"""A contour file that cannot be read, said in one form: which file, which line, what to do."""

from intake.json_syntax import shown
from schemas.problem import InputError, ProblemType


def unreadable(name: str, what: str, remedy: str, *, line: int | None = None) -> InputError:
    """The error for file `name` at `line`, counted from 1. The name is shown, never opened."""
    where = f"`{shown(name)}`" + ("" if line is None else f", line {line}")
    return InputError(
        ProblemType.UNREADABLE_CONTOUR_FILE,
        f"{where}: {what}. Remedy: {remedy}.",
        pointer=shown(name),
    )
