"""A multipart submission, taken apart: one JSON part, files by name, and reference meshes."""

from collections.abc import AsyncIterator, Sequence
from contextlib import asynccontextmanager
from dataclasses import dataclass, field
from typing import BinaryIO

from fastapi import Request
from starlette.datastructures import FormData, UploadFile

from intake.json_syntax import shown
from intake.limits import Limits
from intake.references import reference_part, referenced_surface
from schemas.problem import InputError, ProblemPart, ProblemType
from schemas.vocabulary import Structure

FORM = "multipart/form-data"
REQUEST_PART = "request"
FILE_PART = "file"
"""A part that comes once for each file of a set, which the names of the files tell apart."""


@dataclass(frozen=True)
class FormUpload:
    """The parts of the form. Files lie on disk, or in memory below 1 MB, until the answer.

    files: by the name of their part; those of a set by `file` and their own name. references: by
    the surface that they are the truth of.
    """

    request: bytes
    files: dict[str, BinaryIO] = field(default_factory=dict)
    references: dict[str, BinaryIO] = field(default_factory=dict)


@asynccontextmanager
async def received_form(
    request: Request,
    files: Sequence[str],
    limits: Limits,
    *,
    max_json_bytes: int,
    set_of: int = 0,
) -> AsyncIterator[FormUpload]:
    """Read the form, part by part to disk; the files are closed with the context.

    Args:
        request: Its body is a form.
        files: Parts that may come beside `request` and the references, each a file.
        limits: How many references may come.
        max_json_bytes: Of the part `request`.
        set_of: How many parts `file` may come.

    Names that the client gives its files are looked at only where they come in a set: they tell
    them apart and are shown, and nothing is opened by them. Raises InputError.
    """
    most = 1 + len(files) + limits.max_references + set_of
    async with request.form(
        # One more than is welcome, to be refused by name below; and so are files sent as text.
        max_files=most + 1,
        max_fields=most + 1,
        max_part_size=max_json_bytes,
    ) as form:
        _check_names(form, files, limits, set_of)
        raw = await _json_part(form, max_json_bytes)
        _check_files(form, files)
        sent = {name: part.file for name, part in form.items() if isinstance(part, UploadFile)}
        yield FormUpload(
            raw,
            {name: sent[name] for name in files if name in sent} | _set_of_files(form),
            {
                surface: file
                for name, file in sent.items()
                if (surface := referenced_surface(name)) is not None
            },
        )


def _set_of_files(form: FormData) -> dict[str, BinaryIO]:
    """The parts `file`, by the last step of the name that each was given."""
    found: dict[str, BinaryIO] = {}
    for part in form.getlist(FILE_PART):
        if isinstance(part, UploadFile):
            name = (part.filename or "").replace("\\", "/").rsplit("/", 1)[-1]
            if not name or f"{FILE_PART} {name}" in found:
                what = "has no name" if not name else f"`{shown(name)}` is sent more than once"
                raise InputError(
                    ProblemType.INVALID_REQUEST,
                    f"a part `{FILE_PART}` {what}. Remedy: give each file a name of its own.",
                    pointer=FILE_PART,
                )
            found[f"{FILE_PART} {name}"] = part.file
    return found


def _check_names(form: FormData, files: Sequence[str], limits: Limits, set_of: int) -> None:
    names = [name for name, _ in form.multi_items()]
    in_set = names.count(FILE_PART) if set_of else 0
    if in_set > set_of:
        raise InputError(
            ProblemType.TOO_LARGE,
            f"{in_set} files; at most {set_of} are accepted. Remedy: send fewer frames a job.",
            pointer=FILE_PART,
            status=413,
        )
    names = [name for name in names if not (set_of and name == FILE_PART)]
    references = [name for name in dict.fromkeys(names) if referenced_surface(name) is not None]
    known = [REQUEST_PART, *files, *references]
    faults = [
        ProblemPart(pointer=name, detail=_unknown(name)) for name in names if name not in known
    ]
    faults += [
        ProblemPart(pointer=name, detail="sent more than once")
        for name in sorted(known)
        if names.count(name) > 1
    ]
    faults += [
        ProblemPart(pointer=name, detail=f"one more than {limits.max_references} references")
        for name in references[limits.max_references :]
    ]
    if REQUEST_PART not in names:
        faults.append(ProblemPart(pointer=REQUEST_PART, detail="missing"))
    _refuse(faults, files)


def _unknown(name: str) -> str:
    if name.startswith(reference_part("")):
        return f"names no surface; its end is one of {', '.join(Structure)}"
    return "unknown part"


async def _json_part(form: FormData, max_bytes: int) -> bytes:
    body = form[REQUEST_PART]
    if isinstance(body, UploadFile):
        # `curl -F 'request=@request.json'` sends the JSON as a file; that is welcome too.
        raw = await body.read(max_bytes + 1)
    else:
        raw = body.encode()
    if len(raw) > max_bytes:
        raise InputError(
            ProblemType.TOO_LARGE,
            f"part `{REQUEST_PART}` has more than {max_bytes} bytes. Remedy: send nothing but the "
            "request in it, and maps and meshes as files.",
            pointer=REQUEST_PART,
            status=413,
        )
    return raw


def _check_files(form: FormData, files: Sequence[str]) -> None:
    _refuse(
        [
            ProblemPart(pointer=name, detail="not a file: give the part a filename")
            for name, part in form.multi_items()
            if name != REQUEST_PART and not isinstance(part, UploadFile)
        ],
        files,
    )


def _refuse(faults: list[ProblemPart], files: Sequence[str]) -> None:
    if faults:
        others = f", the files {', '.join(files)}, those there are," if files else ""
        raise InputError(
            ProblemType.INVALID_REQUEST,
            f"part `{faults[0].pointer}`: {faults[0].detail}. Remedy: send one JSON part "
            f"`{REQUEST_PART}`{others} and references as files called by frame and structure, "
            f"like {reference_part('ED_lv_endo')}, each once.",
            pointer=faults[0].pointer,
            errors=faults,
        )
