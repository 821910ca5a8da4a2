"""The header of a NIfTI label map, judged at the door by the standard library alone."""

import math
from collections.abc import Sequence
from dataclasses import dataclass

from intake.label_map_faults import unreadable, unsupported
from intake.nifti_layout import EXTENDER_BYTES, HEADER_BYTES, raw_fields

DAMAGED_REMEDY = "the file is cut short or its header is wrong; export it anew"

Row = tuple[float, float, float, float]

_TYPES = {
    2: ("uint8", 1),
    4: ("int16", 2),
    8: ("int32", 4),
    16: ("float32", 4),
    64: ("float64", 8),
    256: ("int8", 1),
    512: ("uint16", 2),
    768: ("uint32", 4),
    1024: ("int64", 8),
    1280: ("uint64", 8),
}
_REFUSED_TYPES = {
    1: "1-bit",
    32: "complex64",
    128: "RGB",
    1536: "float128",
    1792: "complex128",
    2048: "complex256",
    2304: "RGBA",
}
_MM_PER_UNIT = {1: 1000.0, 2: 1.0, 3: 0.001}
_MS_PER_UNIT = {8: 1000.0, 16: 1.0, 24: 0.001}


@dataclass(frozen=True)
class NiftiHeader:
    """What a label map says of itself. Lengths are in the file's own unit, `mm_per_unit` mm each.

    shape: voxels along the three spatial axes. frames: length of the time axis, 1 without one.
    pixdim: voxel size along the three axes as the header lists it, not judged yet.
    mm_per_unit: 1 where the header does not say.
    time_step_ms: None where the header does not say.
    quaternion: b, c, d, x, y, z offsets and qfac of the qform; None when it has none.
    sform: first three rows of the sform, voxel index to RAS; None when it has none.
    """

    version: int
    big_endian: bool
    shape: tuple[int, int, int]
    frames: int
    data_type: str
    voxel_bytes: int
    vox_offset: int
    pixdim: tuple[float, float, float]
    mm_per_unit: float
    time_step_ms: float | None
    quaternion: tuple[float, ...] | None
    sform: tuple[Row, Row, Row] | None

    @property
    def inflated_bytes(self) -> int:
        """Size of the whole file before compression, header included."""
        return self.vox_offset + self.voxels * self.voxel_bytes

    @property
    def voxels(self) -> int:
        """Voxels of all frames together."""
        return math.prod(self.shape) * self.frames

    def __str__(self) -> str:
        return f"{_times((*self.shape, self.frames))} voxels of {self.data_type}"


def parse_nifti_header(head: bytes, pointer: str) -> NiftiHeader:
    """The header in `head`, the first 540 bytes of an inflated file or all there are.

    Raises:
        InputError: `UNREADABLE_LABEL_MAP` (not NIfTI, or damaged); `UNSUPPORTED_LABEL_MAP`
            (Analyze, header and image in two files, wrong dimensions or data type).
    """
    raw = raw_fields(head, pointer)
    shape, frames = _dimensions(raw.dim, pointer)
    name, size = _voxel_type(raw.data_type, pointer)
    qfac = -1.0 if raw.pixdim[0] < 0 else 1.0
    return NiftiHeader(
        version=raw.version,
        big_endian=raw.big_endian,
        shape=shape,
        frames=frames,
        data_type=name,
        voxel_bytes=size,
        vox_offset=_voxel_offset(raw.vox_offset, raw.version, pointer),
        pixdim=(raw.pixdim[1], raw.pixdim[2], raw.pixdim[3]),
        mm_per_unit=_MM_PER_UNIT.get(raw.units & 0x07, 1.0),
        time_step_ms=_time_step_ms(raw.pixdim[4], raw.units & 0x38),
        quaternion=(*raw.quaternion, qfac) if raw.qform_code > 0 else None,
        sform=_rows(raw.sform) if raw.sform_code > 0 else None,
    )


def _dimensions(dim: Sequence[int], pointer: str) -> tuple[tuple[int, int, int], int]:
    count, sizes = dim[0], dim[1:]
    if not 1 <= count <= 7:
        raise unreadable(pointer, f"the header counts {count} dimensions", DAMAGED_REMEDY)
    used = sizes[:count]
    if any(n < 1 for n in used):
        raise unreadable(pointer, f"the header gives the dimensions {_times(used)}", DAMAGED_REMEDY)
    if count < 3:
        raise unsupported(
            pointer,
            f"it has {count} dimensions",
            "store the slice as x, y, 1 with the affine of its plane",
        )
    if any(n != 1 for n in used[4:]):
        raise unsupported(
            pointer,
            f"it has the dimensions {_times(used)}; a label map has three, or four with time last",
            "store one label a voxel, without a vector or channel axis",
        )
    return (sizes[0], sizes[1], sizes[2]), sizes[3] if count > 3 else 1


def _voxel_type(code: int, pointer: str) -> tuple[str, int]:
    if code in _TYPES:
        return _TYPES[code]
    name = _REFUSED_TYPES.get(code)
    if name is None:
        raise unreadable(
            pointer, f"the header names no data type of NIfTI ({code})", DAMAGED_REMEDY
        )
    raise unsupported(
        pointer, f"its voxels are {name}", "store the labels as integers, uint8 for preference"
    )


def _voxel_offset(offset: float, version: int, pointer: str) -> int:
    """Where the voxels begin, in bytes from the start of the file."""
    least = HEADER_BYTES[version] + EXTENDER_BYTES
    if not math.isfinite(offset) or offset < least or offset != int(offset):
        raise unreadable(
            pointer,
            f"the header puts the voxels at byte {offset:g}, and they begin at {least} or later",
            DAMAGED_REMEDY,
        )
    return int(offset)


def _time_step_ms(step: float, unit: int) -> float | None:
    if unit not in _MS_PER_UNIT or not math.isfinite(step) or step <= 0:
        return None
    return step * _MS_PER_UNIT[unit]


def _rows(numbers: Sequence[float]) -> tuple[Row, Row, Row]:
    a, b, c, d, e, f, g, h, i, j, k, m = numbers
    return (a, b, c, d), (e, f, g, h), (i, j, k, m)


def _times(sizes: Sequence[int]) -> str:
    return " x ".join(map(str, sizes))
