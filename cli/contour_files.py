"""Contour files of other programs, read from disk."""

from collections.abc import Sequence
from pathlib import Path
from typing import TYPE_CHECKING

from schemas.contour_files import ContourFilesRequest
from schemas.problem import InputError, ProblemType

if TYPE_CHECKING:
    from intake.formats.imported import ImportedStudy


def read_contour_files(
    inputs: Sequence[Path], subject_id: str, settings_file: Path | None = None
) -> "ImportedStudy":
    """The study in files, or folders of files. Raises InputError.

    `settings_file` is the JSON of a `ContourFilesRequest`; its subject id wins where it has one.
    """
    # Loads numpy, which looks up its thread count then: not before the command has said it.
    from intake.formats.registry import import_study
    from intake.json_body import parse_json
    from intake.settings import LimitSettings

    limits = LimitSettings().limits()
    request = ContourFilesRequest(subject_id=_checked(subject_id))
    if settings_file is not None:
        given = parse_json(settings_file.read_bytes(), ContourFilesRequest, limits)
        request = given
        if "subject_id" not in given.model_fields_set:
            request = given.model_copy(update={"subject_id": _checked(subject_id)})
    files: dict[str, bytes] = {}
    left_bytes = limits.max_request_bytes
    for path in _files(inputs):
        if path.name in files:
            raise InputError(
                ProblemType.INVALID_REQUEST,
                f"{path}: a second file of this name; give the files of one subject",
            )
        left_bytes -= path.stat().st_size
        if left_bytes < 0:
            raise InputError(
                ProblemType.TOO_LARGE,
                f"the files have more than {limits.max_request_bytes} bytes; give those of one "
                "subject, or raise NEURALMRI_MAX_REQUEST_BYTES",
            )
        files[path.name] = path.read_bytes()
    return import_study(files, request, limits)


def _files(inputs: Sequence[Path]) -> list[Path]:
    """The files, and those right in the folders, but for hidden ones."""
    found: list[Path] = []
    for path in inputs:
        if path.is_dir():
            inside = sorted(one for one in path.iterdir() if one.is_file())
            found += [one for one in inside if not one.name.startswith(".")]
        else:
            found.append(path)
    return found


def _checked(subject_id: str) -> str:
    from pydantic import TypeAdapter, ValidationError

    from schemas.base import Name

    try:
        return TypeAdapter(Name).validate_python(subject_id)
    except ValidationError as error:
        raise InputError(
            ProblemType.INVALID_REQUEST,
            "--subject-id has 1 to 64 letters, digits, dots, underscores or hyphens",
        ) from error
