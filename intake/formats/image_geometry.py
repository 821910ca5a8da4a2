"""Where an image lies in the patient and in the cardiac cycle: the headers of DICOM images."""

from collections.abc import Mapping
from dataclasses import dataclass
from typing import TYPE_CHECKING

import numpy as np
from numpy.typing import NDArray

from intake.formats.clinical_faults import unreadable
from intake.formats.dicom_file import SOP_INSTANCE_UID, numbers, read_dicom, text
from intake.formats.roi_names import view_told
from intake.planes import cross
from schemas.vocabulary import View

if TYPE_CHECKING:
    from pydicom.dataset import Dataset

Array = NDArray[np.float64]

_SERIES_DESCRIPTION = 0x0008103E
_TRIGGER_TIME = 0x00181060
_IMAGE_POSITION = 0x00200032
_IMAGE_ORIENTATION = 0x00200037
_TEMPORAL_POSITION = 0x00200100
_PIXEL_SPACING = 0x00280030

_MOST = 1e5
_FARTHEST_MM = 1e7
_NOT_SQUARE = 1e-2
"""How far directions may be from unit length and from a right angle."""


@dataclass(frozen=True, eq=False)
class ImageGeometry:
    """Plane and time of one image. LPS, mm, ms.

    row, column: directions in which the column and the row index grow (the two halves of Image
    Orientation). spacing_mm: between rows, between columns, as Pixel Spacing has them.
    """

    position_mm: Array
    row: Array
    column: Array
    spacing_mm: tuple[float, float]
    temporal_position: int | None = None
    trigger_ms: float | None = None
    view: View | None = None

    @property
    def normal(self) -> Array:
        return cross(self.row, self.column)

    def to_patient(self, pixels: Array) -> Array:
        """Patient coordinates (n, 3), mm, of (n, 2) column and row indices; 0, 0 is the centre of
        the first pixel (PS3.3, C.7.6.2.1.1).
        """
        between_rows, between_columns = self.spacing_mm
        steps = np.stack([self.row * between_columns, self.column * between_rows])
        return self.position_mm + pixels @ steps


def geometry(
    position: Array,
    orientation: Array,
    spacing: Array,
    *,
    temporal_position: int | None = None,
    trigger_ms: float | None = None,
    view: View | None = None,
) -> ImageGeometry | None:
    """Of a position (3,), an orientation (6,) and a spacing (2,); None where they are none."""
    if position.shape != (3,) or orientation.shape != (6,) or spacing.shape != (2,):
        return None
    row, column = orientation[:3], orientation[3:]
    lengths = float(np.linalg.norm(row)), float(np.linalg.norm(column))
    off = abs(lengths[0] - 1), abs(lengths[1] - 1), abs(float(row @ column))
    if max(off) > _NOT_SQUARE:
        return None
    if not (spacing > 0).all() or max(np.abs(position).max(), spacing.max()) > _FARTHEST_MM:
        return None
    return ImageGeometry(
        position_mm=position,
        row=row / lengths[0],
        column=column / lengths[1],
        spacing_mm=(float(spacing[0]), float(spacing[1])),
        temporal_position=temporal_position,
        trigger_ms=trigger_ms,
        view=view,
    )


def image_of(data: bytes, file: str, max_inflated_bytes: int) -> tuple[str, ImageGeometry | None]:
    """The SOP instance UID of a DICOM image, and its geometry where it has one; pixels unread.

    Raises:
        InputError: at `file`, as `read_dicom`, or for an image without a UID.
    """
    header = read_dicom(data, file, frozenset(), max_inflated_bytes)
    uid = text(header, SOP_INSTANCE_UID)
    if not uid:
        raise unreadable(
            file, "has no SOP Instance UID", "send the images that the contours were drawn on"
        )
    said = [numbers(header, t) for t in (_IMAGE_POSITION, _IMAGE_ORIENTATION, _PIXEL_SPACING)]
    position, orientation, spacing = (np.empty(0) if s is None else s for s in said)
    return uid, geometry(
        position,
        orientation,
        spacing,
        temporal_position=None
        if (index := _first(header, _TEMPORAL_POSITION)) is None
        else int(index),
        trigger_ms=_first(header, _TRIGGER_TIME),
        view=view_told(text(header, _SERIES_DESCRIPTION)),
    )


def _first(header: "Dataset", tag: int) -> float | None:
    """A count or a time; None for one that no image can have."""
    said = numbers(header, tag)
    return None if said is None or not 0 <= said[0] <= _MOST else float(said[0])


Images = Mapping[str, ImageGeometry]
"""By SOP instance UID."""
