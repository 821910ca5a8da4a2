"""The contour files that are read: adding a format is one entry in FORMATS."""

from collections.abc import Callable, Mapping
from dataclasses import dataclass

from intake.formats.csl import read_csl
from intake.formats.csl_planes import looks_like_csl
from intake.formats.cvi42 import looks_like_cvi42, read_cvi42
from intake.formats.dicom_file import is_dicom
from intake.formats.faults import unreadable
from intake.formats.geometry_table import is_table
from intake.formats.guide_point_rows import looks_like_guide_points
from intake.formats.guide_points import read_guide_points
from intake.formats.imported import ImportedStudy
from intake.formats.rtstruct import looks_like_rtstruct, read_rtstruct
from intake.formats.slice_info import looks_like_slice_info
from intake.json_syntax import shown
from intake.limits import Limits
from intake.study import shortened
from schemas.contour_files import ContourFilesRequest, ContourFormat
from schemas.problem import InputError, ProblemType

Files = Mapping[str, bytes]
"""Contents by name. A name is shown and tells frames; it is no path."""


@dataclass(frozen=True)
class FileFormat:
    """A format: which files are of it, by their content, and how they are read.

    goes_with: which files may come along that hold no contour, and say where images lie.
    """

    recognises: Callable[[bytes], bool]
    read: Callable[[Files, ContourFilesRequest, Limits], ImportedStudy]
    goes_with: Callable[[bytes], bool] = lambda _: False


def _tells_of_images(body: bytes) -> bool:
    return is_dicom(body) or is_table(body)


FORMATS: dict[ContourFormat, FileFormat] = {
    ContourFormat.GUIDE_POINTS: FileFormat(
        recognises=lambda body: looks_like_guide_points(body) or looks_like_slice_info(body),
        read=lambda files, request, limits: read_guide_points(
            files, request.guide_points, subject_id=request.subject_id, limits=limits
        ),
    ),
    ContourFormat.CSL: FileFormat(
        recognises=looks_like_csl,
        read=lambda files, request, limits: read_csl(
            files, request.csl, subject_id=request.subject_id, limits=limits
        ),
    ),
    ContourFormat.RTSTRUCT: FileFormat(
        recognises=looks_like_rtstruct,
        read=lambda files, request, limits: read_rtstruct(
            files,
            structures=request.rtstruct.structures,
            subject_id=request.subject_id,
            limits=limits,
        ),
        goes_with=_tells_of_images,
    ),
    ContourFormat.CVI42: FileFormat(
        recognises=looks_like_cvi42,
        read=lambda files, request, limits: read_cvi42(
            files, subject_id=request.subject_id, limits=limits
        ),
        goes_with=_tells_of_images,
    ),
}


def import_study(files: Files, request: ContourFilesRequest, limits: Limits) -> ImportedStudy:
    """The study in `files`, by the format that the request names or the content tells.

    Raises:
        InputError: `UNREADABLE_CONTOUR_FILE`, naming file and line, or files of no one format.
    """
    if not files:
        raise InputError(
            ProblemType.INVALID_REQUEST,
            "no contour file was sent. Remedy: send at least one.",
            pointer="file",
        )
    one = FORMATS[request.format or told_format(files)]
    imported = one.read(files, request, limits)
    return ImportedStudy(imported.study, tuple(shortened(list(imported.warnings))))


def told_format(files: Files) -> ContourFormat:
    """The format that every file is of, or goes with. Raises InputError for the first that is of
    none of them.
    """
    found: dict[ContourFormat, str] = {}
    others: dict[str, bytes] = {}
    for name, body in files.items():
        known = [one for one, format_ in FORMATS.items() if format_.recognises(body)]
        if known:
            found.setdefault(known[0], name)
        else:
            others[name] = body
    for name, body in others.items():
        if not any(FORMATS[one].goes_with(body) for one in found):
            raise unknown_format(name)
    if len(found) > 1:
        said = ", ".join(f"`{shown(name)}` is {one.value}" for one, name in found.items())
        raise InputError(
            ProblemType.UNREADABLE_CONTOUR_FILE,
            f"the files are of several formats: {said}. Remedy: send one subject in one format.",
            pointer=shown(list(found.values())[1]),
        )
    return next(iter(found))


def unknown_format(name: str) -> InputError:
    """The error for a file that no format recognises."""
    return unreadable(
        name,
        f"of no format that is told by its content ({', '.join(ContourFormat)})",
        "send files of one of these formats, or a contour study as JSON to /v1/jobs/contours",
    )
