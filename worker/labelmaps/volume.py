"""A label map's voxels: read as they are stored, checked to be labels, a frame at a time."""

import gzip
from collections.abc import Iterator
from pathlib import Path

import nibabel
import numpy as np
from jaxtyping import Int, UInt8

from intake.inflate import is_gzip
from intake.label_map_faults import unsupported
from intake.nifti_header import NiftiHeader
from schemas.labels import TissueLabels
from worker.labelmaps.scheme import Tissue, values_by_tissue

Labels = Int[np.ndarray, "x y z"]
"""Label values of one frame, as the file numbers them."""

TissueImage = UInt8[np.ndarray, "i j"]
"""`Tissue` of every pixel of one slice."""

Tissues = UInt8[np.ndarray, "x y z"]
"""`Tissue` of every voxel of one frame."""

_REMEDY = "send the segmentation itself, one integer a voxel, resampled with nearest neighbour only"

_MOST_LABELS = 256
"""A map with more values than this is an image, or a distance or probability map."""


def read_frames(path: Path, header: NiftiHeader, pointer: str) -> Iterator[Labels]:
    """The frames of a NIfTI file, whose header has been checked, in order, as integers.

    Raises:
        InputError: `UNSUPPORTED_LABEL_MAP` when a voxel is no integer, or values are too many.
    """
    with gzip.open(path) if is_gzip(path) else path.open("rb") as stream:
        format_ = {1: nibabel.Nifti1Image, 2: nibabel.Nifti2Image}[header.version]
        proxy = format_.from_stream(stream).dataobj
        for index in range(header.frames):
            beyond = (index, *(0,) * (len(proxy.shape) - 4)) if len(proxy.shape) > 3 else ()
            yield _as_integers(np.asanyarray(proxy[(slice(None),) * 3 + beyond]), pointer)


def label_values(labels: Labels) -> frozenset[int]:
    """The values that occur, without 0."""
    return frozenset(np.unique(labels[labels != 0]).tolist())


def to_tissues(labels: Labels, scheme: TissueLabels) -> Tissues:
    """Tissue of every voxel by a scheme; values it ignores or does not know are background."""
    tissues = np.full(labels.shape, Tissue.BACKGROUND, dtype=np.uint8)
    for tissue, values in values_by_tissue(scheme).items():
        for value in values:
            tissues[labels == value] = tissue
    return tissues


def _as_integers(values: np.ndarray, pointer: str) -> Labels:
    distinct = np.unique(values[values != 0])
    if np.issubdtype(values.dtype, np.floating):
        if not np.isfinite(distinct).all():
            raise unsupported(pointer, "it holds NaN or infinite voxels", _REMEDY)
        broken = distinct[distinct != np.rint(distinct)]
        if len(broken):
            raise unsupported(
                pointer,
                f"it holds values that are no integers, such as {broken[0]:.4g}; this is a "
                "probability map, or labels were resampled by interpolation",
                _REMEDY,
            )
    if len(distinct) > _MOST_LABELS:
        raise unsupported(
            pointer,
            f"it holds {len(distinct)} different values, like an image rather than labels",
            _REMEDY,
        )
    largest = max((abs(int(value)) for value in distinct), default=0)
    if largest > np.iinfo(np.int32).max:
        raise unsupported(pointer, f"it holds a value of size {largest}", _REMEDY)
    return values.astype(np.int16 if largest <= np.iinfo(np.int16).max else np.int32)
