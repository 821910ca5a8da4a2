"""`SliceInfoFile.txt`: where the slices of guide points lie, one a line."""

import math
from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

from intake.formats.faults import unreadable
from intake.formats.text_file import numbered_lines

Array = NDArray[np.float64]

_POSITION, _ORIENTATION = "ImagePositionPatient", "ImageOrientationPatient"
_IDS = ("sliceid:", "frameid:")
_REMEDY = (
    f"a line has `sliceID:`, {_POSITION} with 3 numbers and {_ORIENTATION} with 6, between tabs"
)


@dataclass(frozen=True, eq=False)
class ImagePlane:
    """Where an image lies: origin (3,), LPS mm, and the unit directions (2, 3) of its rows."""

    origin_mm: Array
    directions: Array

    @property
    def normal(self) -> Array:
        return np.cross(self.directions[0], self.directions[1])


def looks_like_slice_info(content: bytes) -> bool:
    """Whether the first lines say where images lie."""
    start = content[:4096].decode("utf-8-sig", "replace")
    return _POSITION in start and any(one in start.lower() for one in _IDS)


def read_slice_info(name: str, content: bytes) -> dict[str, ImagePlane]:
    """The plane of each slice by its id. Raises InputError at the first line that is no plane."""
    planes: dict[str, ImagePlane] = {}
    for number, line in numbered_lines(name, content):
        values = [value.strip() for value in line.split("\t")]
        slice_ = _id_of(name, number, values)
        plane = _plane(name, number, values)
        if slice_ in planes and not _same(planes[slice_], plane):
            raise unreadable(
                name,
                f"slice {slice_} is given twice, in different places",
                "give each slice once",
                line=number,
            )
        planes[slice_] = plane
    return planes


def _id_of(name: str, line: int, values: list[str]) -> str:
    for k, value in enumerate(values):
        key = next((one for one in _IDS if value.lower().startswith(one)), None)
        if key is not None:
            found = value[len(key) :].strip() or (values[k + 1] if k + 1 < len(values) else "")
            if found and len(found) <= 64:
                return found.removesuffix(".0")
    raise unreadable(name, "no slice id", _REMEDY, line=line)


def _plane(name: str, line: int, values: list[str]) -> ImagePlane:
    origin_mm = _numbers(name, line, values, _POSITION, 3)
    directions = _numbers(name, line, values, _ORIENTATION, 6).reshape(2, 3)
    lengths = np.linalg.norm(directions, axis=1)
    if np.abs(lengths - 1.0).max() > 0.01 or abs(directions[0] @ directions[1]) > 0.01:
        raise unreadable(
            name,
            f"{_ORIENTATION} is no pair of unit vectors at right angles",
            "send it as the image's DICOM header has it",
            line=line,
        )
    return ImagePlane(origin_mm, directions / lengths[:, None])


def _numbers(name: str, line: int, values: list[str], key: str, count: int) -> Array:
    try:
        at = values.index(key) + 1
        found = [float(value) for value in values[at : at + count]]
    except ValueError:
        found = []
    if len(found) != count or not all(math.isfinite(v) and abs(v) <= 1e5 for v in found):
        raise unreadable(name, f"{key} has not {count} numbers", _REMEDY, line=line)
    return np.array(found)


def _same(a: ImagePlane, b: ImagePlane) -> bool:
    return bool(
        np.allclose(a.origin_mm, b.origin_mm, atol=1e-3)
        and np.allclose(a.directions, b.directions, atol=1e-4)
    )
