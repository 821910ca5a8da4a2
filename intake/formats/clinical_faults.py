"""How a clinical file is refused: which file, what is wrong, what to do. Nothing of its content
but names of structures is repeated: it may name a patient.
"""

from schemas.problem import InputError, ProblemType


def unreadable(file: str, how: str, remedy: str) -> InputError:
    """The error for file `file` that is damaged, or not of the kind that it should be."""
    return InputError(
        ProblemType.UNREADABLE_CONTOUR_FILE, f"The file {how}. Remedy: {remedy}.", pointer=file
    )


def unusable(what: str, remedy: str) -> InputError:
    """The error for files that can be read, and make no study."""
    return InputError(ProblemType.UNREADABLE_CONTOUR_FILE, f"{what}. Remedy: {remedy}.")


def too_large(file: str | None, what: str, remedy: str) -> InputError:
    """The error (413) for more than one request may hold."""
    return InputError(ProblemType.TOO_LARGE, f"{what}. Remedy: {remedy}.", pointer=file, status=413)
