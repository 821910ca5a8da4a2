"""The two ways in which a file is no label map, each said in one form."""

from schemas.problem import InputError, ProblemType


def unreadable(pointer: str, how: str, remedy: str) -> InputError:
    """The error for file part `pointer` that is damaged, or no NIfTI at all."""
    return InputError(
        ProblemType.UNREADABLE_LABEL_MAP,
        f"`{pointer}` is not a readable NIfTI label map: {how}. Remedy: {remedy}.",
        pointer=pointer,
    )


def unsupported(pointer: str, what: str, remedy: str) -> InputError:
    """The error for file part `pointer` that is sound, and of a kind that is not read here."""
    return InputError(
        ProblemType.UNSUPPORTED_LABEL_MAP,
        f"`{pointer}` is no label map: {what}. Remedy: {remedy}.",
        pointer=pointer,
    )
