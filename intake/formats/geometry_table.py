"""A table of image geometry, for callers who do not send the images: JSON or CSV."""

import csv
import io
from typing import Annotated

import numpy as np
from pydantic import Field, ValidationError

from intake.formats.clinical_faults import too_large, unreadable
from intake.formats.image_geometry import ImageGeometry, geometry
from intake.json_body import parse_json
from intake.limits import Limits
from schemas.base import WireModel
from schemas.problem import InputError
from schemas.vocabulary import View

Number = Annotated[float, Field(ge=-1e7, le=1e7)]

COLUMNS = ("uid", "position", "orientation", "spacing", "temporal_position", "trigger_ms", "view")
"""Of a CSV table; those up to `spacing` are required. Numbers of one cell are parted by backslashes
(as in DICOM) or spaces."""

_NUMBERS = ("position", "orientation", "spacing")
_REQUIRED = COLUMNS[:4]
_MAX_IMAGES = 20_000
_REMEDY = "see docs/clinical-files.md for the columns of a geometry table"


class ImageEntry(WireModel):
    """One image: the DICOM attributes of the same names, LPS, mm, ms."""

    uid: Annotated[str, Field(min_length=1, max_length=64)]
    position: tuple[Number, Number, Number]
    orientation: tuple[Number, Number, Number, Number, Number, Number]
    spacing: tuple[Number, Number]
    temporal_position: Annotated[int, Field(ge=0, le=100_000)] | None = None
    trigger_ms: Annotated[float, Field(ge=0, le=1e5)] | None = None
    view: View | None = None


class GeometryTable(WireModel):
    """The JSON form."""

    images: list[ImageEntry] = Field(min_length=1, max_length=_MAX_IMAGES)


def read_geometry_table(data: bytes, file: str, limits: Limits) -> dict[str, ImageGeometry]:
    """Geometry by SOP instance UID, from JSON (`{"images": [...]}`) or CSV.

    Raises:
        InputError: at `file`, with the line or the place at fault.
    """
    entries = _of_json(data, file, limits) if _is_json(data) else _of_csv(data, file)
    found: dict[str, ImageGeometry] = {}
    for entry in entries:
        one = geometry(
            np.array(entry.position),
            np.array(entry.orientation),
            np.array(entry.spacing),
            temporal_position=entry.temporal_position,
            trigger_ms=entry.trigger_ms,
            view=entry.view,
        )
        if one is None:
            raise unreadable(
                file,
                f"has an image ({entry.uid}) whose orientation is not two unit vectors at a right "
                "angle, or whose spacing is not positive",
                "copy Image Orientation (Patient) and Pixel Spacing as DICOM has them",
            )
        found[entry.uid] = one
    return found


def is_table(data: bytes) -> bool:
    """Whether a file is JSON, or its first line has the required columns of a CSV table."""
    if _is_json(data):
        return True
    head = data[:1024].removeprefix(b"\xef\xbb\xbf").splitlines()[:1]
    words = head[0].decode("ascii", "replace").lower().split(",") if head else []
    return set(_REQUIRED) <= {word.strip() for word in words}


def _is_json(data: bytes) -> bool:
    return data[:64].lstrip()[:1] in (b"{", b"[")


def _of_json(data: bytes, file: str, limits: Limits) -> list[ImageEntry]:
    try:
        return parse_json(data, GeometryTable, limits).images
    except InputError as error:
        raise InputError(error.type, error.detail, pointer=file, status=error.status) from error


def _of_csv(data: bytes, file: str) -> list[ImageEntry]:
    try:
        lines = io.StringIO(data.decode("utf-8-sig"), newline="")
        rows = csv.DictReader(lines, strict=True, skipinitialspace=True)
        rows.fieldnames = [name.strip().lower() for name in rows.fieldnames or ()]
        unknown = set(rows.fieldnames) - set(COLUMNS)
        if unknown or not set(_REQUIRED) <= set(rows.fieldnames):
            raise unreadable(file, "has not the columns of a geometry table", _REMEDY)
        entries: list[ImageEntry] = []
        for row in rows:
            if len(entries) == _MAX_IMAGES:
                raise too_large(
                    file, f"The table has more than {_MAX_IMAGES} images", "leave out what has none"
                )
            entries.append(_entry(row, rows.line_num, file))
    except (UnicodeDecodeError, csv.Error) as error:
        raise unreadable(file, "is not a CSV table in UTF-8", _REMEDY) from error
    return entries


def _entry(row: dict[str, str | None], line: int, file: str) -> ImageEntry:
    filled = {key: value.strip() for key, value in row.items() if key and value and value.strip()}
    said: dict[str, object] = dict(filled)
    for name in _NUMBERS:
        said[name] = tuple(filled.get(name, "").replace("\\", " ").split())
    try:
        return ImageEntry.model_validate(said)
    except ValidationError as error:
        column = error.errors(include_input=False, include_url=False)[0]["loc"][0]
        raise unreadable(
            file, f"has no valid `{column}` on line {line}", f"correct the cell; {_REMEDY}"
        ) from error
