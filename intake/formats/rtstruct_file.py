"""The regions of one RT Structure Set: names, and contours as the file has them."""

from collections import Counter
from collections.abc import Mapping
from dataclasses import dataclass, field
from typing import TYPE_CHECKING

import numpy as np
from numpy.typing import NDArray

from intake.formats.clinical_faults import unreadable
from intake.formats.dicom_file import (
    SOP_CLASS_UID,
    character_set,
    items,
    names,
    numbers,
    raw,
    read_dicom,
    text,
)
from intake.formats.found_contour import FoundContour, without_repeats
from intake.formats.keyhole import split_keyholes
from intake.formats.roi_names import RoiName, understood
from intake.limits import Limits
from schemas.problem import InputError
from schemas.vocabulary import Structure

if TYPE_CHECKING:
    from pydicom.dataset import Dataset

RT_STRUCTURE_SET = "1.2.840.10008.5.1.4.1.1.481.3"

_LABELS = (0x30060002, 0x30060004, 0x0008103E)
"""Structure Set Label and Name, Series Description: looked through for ED and ES alone."""
_STRUCTURE_SET_ROIS = 0x30060020
_ROI_NUMBER = 0x30060022
_ROI_NAME = 0x30060026
_ROI_CONTOURS = 0x30060039
_REFERENCED_ROI = 0x30060084
_CONTOURS = 0x30060040
_CONTOUR_IMAGES = 0x30060016
_REFERENCED_IMAGE = 0x00081155
_GEOMETRIC_TYPE = 0x30060042
_POINT_COUNT = 0x30060046
_CONTOUR_DATA = 0x30060050
_ENTERED = frozenset((_STRUCTURE_SET_ROIS, _ROI_CONTOURS, _CONTOURS, _CONTOUR_IMAGES))

_CLOSED = ("CLOSED_PLANAR", "CLOSEDPLANAR_XOR")
_OPEN = "OPEN_PLANAR"
_FARTHEST_MM = 1e7


@dataclass(eq=False)
class StructureSet:
    """What one file holds of the ventricles. `unknown`: names that mean no structure.

    left_out: why contours of the ventricles were left out, and how many. instant: ED or ES where
    a label of the whole file says it.
    """

    contours: list[FoundContour] = field(default_factory=list)
    known: list[str] = field(default_factory=list)
    unknown: list[str] = field(default_factory=list)
    left_out: Counter[str] = field(default_factory=Counter)
    instant: str | None = None


def read_structure_set(
    data: bytes, file: str, structures: Mapping[str, Structure], limits: Limits
) -> StructureSet:
    """The contours of an RT Structure Set; `structures` by whole names goes before known names.

    Raises:
        InputError: at `file`: not such a file, damaged, or with coordinates that are none.
    """
    dataset = read_dicom(data, file, _ENTERED, limits.max_inflated_bytes)
    if text(dataset, SOP_CLASS_UID) != RT_STRUCTURE_SET:
        raise unreadable(
            file,
            "is a DICOM file of another kind than RT Structure Set",
            "export the contours as RTSTRUCT (SOP class " + RT_STRUCTURE_SET + ")",
        )
    letters = character_set(dataset)
    of_file = [understood(names(dataset, tag, letters), {}).instant for tag in _LABELS]
    found = StructureSet(instant=next((said for said in of_file if said), None))
    means = _meanings(dataset, file, structures, letters, found)
    for roi in items(dataset, _ROI_CONTOURS, file):
        meaning = means.get(text(roi, _REFERENCED_ROI))
        if meaning is None or meaning.structure is None:
            continue
        for item in items(roi, _CONTOURS, file):
            closed, outlines = _outlines(item, file, found.left_out)
            image = _image(item, file)
            found.contours += [
                FoundContour(
                    structure=meaning.structure,
                    closed=closed,
                    points_mm=outline,
                    image=image,
                    instant=meaning.instant,
                    view=meaning.view,
                )
                for outline in outlines
            ]
    return found


def is_structure_set(data: bytes) -> bool:
    """Whether the beginning of a DICOM file names the SOP class, as its meta information does."""
    return RT_STRUCTURE_SET.encode() in data[:1024]


def _meanings(
    dataset: "Dataset",
    file: str,
    structures: Mapping[str, Structure],
    letters: str,
    found: StructureSet,
) -> dict[str, RoiName]:
    """By ROI number. Names are noted in `found`."""
    means: dict[str, RoiName] = {}
    for roi in items(dataset, _STRUCTURE_SET_ROIS, file):
        name = names(roi, _ROI_NAME, letters)
        meaning = understood(name, structures)
        means[text(roi, _ROI_NUMBER)] = meaning
        (found.known if meaning.structure else found.unknown).append(name)
    return means


def _outlines(
    item: "Dataset", file: str, left_out: Counter[str]
) -> tuple[bool, list[NDArray[np.float64]]]:
    """Whether a contour is closed, and its outlines: several where a keyhole joins them."""
    kind = text(item, _GEOMETRIC_TYPE)
    if kind not in _CLOSED and kind != _OPEN:
        left_out["are points or not planar"] += 1
        return False, []
    points = _points(item, file)
    closed = kind in _CLOSED or (len(points) > 3 and bool((points[0] == points[-1]).all()))
    outline = without_repeats(points)
    kept = [one for one in (split_keyholes(outline) if closed else [outline]) if len(one) >= 3]
    if not kept:
        left_out["have fewer than three points"] += 1
    return closed, kept


def _points(item: "Dataset", file: str) -> NDArray[np.float64]:
    if not raw(item, _CONTOUR_DATA):
        return np.empty((0, 3))
    values = numbers(item, _CONTOUR_DATA)
    if values is None or len(values) % 3 or np.abs(values).max() > _FARTHEST_MM:
        raise _bad_points(file, "has contour data that are not triplets of finite numbers in mm")
    count = numbers(item, _POINT_COUNT)
    if count is not None and count[0] != len(values) // 3:
        raise _bad_points(file, "has a contour with another number of points than it says")
    return values.reshape(-1, 3)


def _bad_points(file: str, how: str) -> InputError:
    return unreadable(
        file, how, "export it anew; as Implicit VR where a contour has thousands of points"
    )


def _image(item: "Dataset", file: str) -> str:
    first = next(items(item, _CONTOUR_IMAGES, file), None)
    return "" if first is None else text(first, _REFERENCED_IMAGE)
