"""The rows of a guide-point file: one point a line."""

import math
import re
from dataclasses import dataclass

from intake.formats.faults import unreadable
from intake.formats.text_file import fields, numbered_lines

_REMEDY = "a guide point has x, y, z, contour type, slice, weight and time frame, between tabs"
_TYPE = re.compile(r"[A-Z][A-Z0-9_]{1,63}", re.ASCII)
_SLICE = re.compile(r"[A-Za-z0-9][A-Za-z0-9._-]{0,63}", re.ASCII)
_FARTHEST_MM = 1e5


@dataclass(frozen=True, slots=True)
class GuidePoint:
    """One point, mm, and the line that it stands on."""

    point_mm: tuple[float, float, float]
    contour_type: str
    slice: str
    weight: float
    time_frame: str
    line: int


def looks_like_guide_points(content: bytes) -> bool:
    """Whether a file's first lines are a header or rows of guide points."""
    for line in content[:2048].decode("utf-8-sig", "replace").split("\n")[:2]:
        values = fields(line)
        if [value.lower() for value in values[:4]] == ["x", "y", "z", "contour type"]:
            return True
        if len(values) >= 5 and values[3].startswith(("SAX_", "LAX_")):
            return True
    return False


def read_rows(name: str, content: bytes, most: int) -> list[GuidePoint]:
    """The points of file `name`, in its order; a header line is skipped.

    Raises InputError at the first line that is none, or after more than `most` points.
    """
    rows: list[GuidePoint] = []
    for number, line in numbered_lines(name, content):
        values = fields(line)
        if not rows and values[0].lower() == "x":
            continue
        if len(rows) == most:
            raise unreadable(
                name, f"more than {most} points", "send fewer frames a job", line=number
            )
        rows.append(_row(name, number, values))
    if not rows:
        raise unreadable(name, "no point is in it", "leave the file out, or send one with points")
    return rows


def _row(name: str, line: int, values: list[str]) -> GuidePoint:
    if len(values) < 5:
        raise unreadable(name, f"{len(values)} values where at least 5 are", _REMEDY, line=line)
    x, y, z = (_number(name, line, axis, values["xyz".index(axis)]) for axis in "xyz")
    contour_type, slice_ = values[3], values[4]
    if not _TYPE.fullmatch(contour_type):
        raise unreadable(name, "the fourth value is no contour type", _REMEDY, line=line)
    if slice_.endswith(".0"):
        slice_ = slice_[:-2]  # written by a program that holds ids as floats
    if not _SLICE.fullmatch(slice_):
        raise unreadable(name, "the fifth value is no slice id", _REMEDY, line=line)
    weight = _number(name, line, "weight", values[5]) if len(values) > 5 and values[5] else 1.0
    time_frame = values[6] if len(values) > 6 else ""
    return GuidePoint((x, y, z), contour_type, slice_, weight, time_frame, line)


def _number(name: str, line: int, what: str, text: str) -> float:
    try:
        value = float(text)
    except ValueError:
        value = math.nan
    if not abs(value) <= _FARTHEST_MM:
        raise unreadable(
            name,
            f"{what} is no number of at most {_FARTHEST_MM:g}",
            _REMEDY + "; correct the number or leave the line out",
            line=line,
        )
    return value
