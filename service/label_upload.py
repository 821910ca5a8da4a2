"""A multipart label submission, taken apart: one JSON part and one file a view."""

from collections.abc import AsyncIterator
from dataclasses import dataclass
from typing import BinaryIO

from fastapi import Request
from starlette.datastructures import UploadFile

from schemas.problem import InputError, ProblemPart, ProblemType
from schemas.vocabulary import View
from service.media_type import require_media_type

REQUEST_PART = "request"
FILE_VIEWS = (View.SAX, View.LAX_2CH, View.LAX_3CH, View.LAX_4CH)

_MAX_JSON_BYTES = 1 << 20


@dataclass(frozen=True)
class LabelUpload:
    """The parts of the form. The files lie on disk, or in memory below 1 MB, until the answer."""

    request: bytes
    files: dict[View, BinaryIO]


async def receive_label_upload(request: Request) -> AsyncIterator[LabelUpload]:
    """Read the form, part by part to disk; the files are closed after the answer.

    Names that the client gives its files are not looked at. Raises InputError.
    """
    require_media_type(request, "multipart/form-data")
    async with request.form(
        max_files=len(FILE_VIEWS) + 1,
        max_fields=len(FILE_VIEWS) + 1,  # views sent as text are refused by name, below
        max_part_size=_MAX_JSON_BYTES,
    ) as form:
        parts = form.multi_items()
        _check_names([name for name, _ in parts])
        body = form[REQUEST_PART]
        if isinstance(body, UploadFile):
            # `curl -F 'request=@request.json'` sends the JSON as a file; that is welcome too.
            raw = await body.read(_MAX_JSON_BYTES + 1)
        else:
            raw = body.encode()
        _check_length(raw)
        files = {
            View(name): part.file
            for name, part in parts
            if isinstance(part, UploadFile)
            if name != REQUEST_PART
        }
        _check_files(files, [name for name, _ in parts])
        yield LabelUpload(raw, files)


def _check_names(names: list[str]) -> None:
    known = {REQUEST_PART, *FILE_VIEWS}
    faults = [
        ProblemPart(pointer=name, detail="unknown part") for name in names if name not in known
    ]
    faults += [
        ProblemPart(pointer=name, detail="sent more than once")
        for name in sorted(known)
        if names.count(name) > 1
    ]
    if REQUEST_PART not in names:
        faults.append(ProblemPart(pointer=REQUEST_PART, detail="missing"))
    _refuse(faults)


def _check_length(raw: bytes) -> None:
    if len(raw) > _MAX_JSON_BYTES:
        raise InputError(
            ProblemType.TOO_LARGE,
            f"part `{REQUEST_PART}` has more than {_MAX_JSON_BYTES} bytes. Remedy: send nothing "
            "but subject, label scheme and options in it.",
            pointer=REQUEST_PART,
            status=413,
        )


def _check_files(files: dict[View, BinaryIO], names: list[str]) -> None:
    _refuse(
        [
            ProblemPart(pointer=name, detail="not a file: give the part a filename")
            for name in names
            if name != REQUEST_PART and name not in files
        ]
    )


def _refuse(faults: list[ProblemPart]) -> None:
    if faults:
        raise InputError(
            ProblemType.INVALID_REQUEST,
            f"part `{faults[0].pointer}`: {faults[0].detail}. Remedy: send one JSON part `request` "
            "and the files sax, lax_2ch, lax_3ch and lax_4ch, those there are, each once.",
            pointer=faults[0].pointer,
            errors=faults,
        )
