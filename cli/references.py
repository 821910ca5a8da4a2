"""Reference meshes that the command line names: `ED_lv_endo=truth.ply`, or `ED_lv_endo.stl`."""

from collections.abc import Sequence
from pathlib import Path

from schemas.problem import InputError, ProblemType
from schemas.surface_name import parse_surface_name
from schemas.vocabulary import Structure


def reference_files(arguments: Sequence[str]) -> dict[str, Path]:
    """Files by the surface that each is the truth of. The meshes themselves are not looked at.

    Raises InputError, naming the remedy, for an argument that names no surface or no file, and for
    a second file of one surface.
    """
    files: dict[str, Path] = {}
    for argument in arguments:
        surface, path = _surface_and_file(argument)
        if parse_surface_name(surface) is None:
            raise _refused(
                f"--reference {argument} names no surface; name it by frame and structure, as in "
                f"--reference ED_lv_endo={path}, with one of {', '.join(Structure)}"
            )
        if surface in files:
            raise _refused(
                f"--reference {argument} is a second reference of {surface}; keep one of them"
            )
        if not path.is_file():
            raise _refused(f"--reference {argument}: there is no file {path}; check the path")
        files[surface] = path
    return files


def _surface_and_file(argument: str) -> tuple[str, Path]:
    name, given, file = argument.partition("=")
    # A folder's name may hold the sign, too.
    if given and "/" not in name:
        return name, Path(file)
    return Path(argument).stem, Path(argument)


def _refused(detail: str) -> InputError:
    return InputError(ProblemType.INVALID_REQUEST, detail)
