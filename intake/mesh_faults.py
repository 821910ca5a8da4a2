"""The two ways in which a mesh file is refused, each said in one form."""

from schemas.problem import InputError, ProblemType


def unreadable_mesh(name: str, how: str, remedy: str) -> InputError:
    """The error for mesh `name`, a file part or a file, that cannot be read as a surface."""
    return InputError(
        ProblemType.INVALID_REQUEST, f"`{name}` {how}. Remedy: {remedy}.", pointer=name
    )


def refuse_triangles(name: str, found: int, limit: int) -> None:
    """Raise InputError (`TOO_LARGE`, 413) for mesh `name` of more than `limit` triangles."""
    if found > limit:
        raise InputError(
            ProblemType.TOO_LARGE,
            f"`{name}` has {found} triangles; at most {limit} are accepted. Remedy: decimate it; "
            "a hundred thousand are ample for a ventricle.",
            pointer=name,
            status=413,
        )
