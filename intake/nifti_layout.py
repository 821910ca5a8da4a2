"""Where a NIfTI header keeps its numbers: version, byte order, fields, as they stand.

Source: nifti1.h (348 bytes) and nifti2.h (540 bytes). Nothing is judged here but the format.
"""

import struct
from dataclasses import dataclass
from typing import Any

from intake.label_map_faults import unreadable
from schemas.problem import InputError, ProblemType

_REMEDY = "send a .nii or .nii.gz file (NIfTI-1 or NIfTI-2)"

HEADER_BYTES = {1: 348, 2: 540}
EXTENDER_BYTES = 4
"""Between the header and the voxels of a single file stand at least these."""

_MAGICS = {1: (b"n+1\0", b"ni1\0"), 2: (b"n+2\0\r\n\x1a\n", b"ni2\0\r\n\x1a\n")}
_MAGIC_AT = {1: 344, 2: 4}
_OTHER_FORMATS = (
    (128, b"DICM", "a DICOM file"),
    (0, b"NRRD", "an NRRD file"),
    (0, b"ObjectType", "a MetaImage file"),
    (0, b"PK\x03\x04", "a zip archive"),
    (0, b"\x89HDF", "an HDF5 (or MINC) file"),
)


@dataclass(frozen=True)
class RawFields:
    """The numbers of a header, unjudged; layouts as in nifti1.h and nifti2.h."""

    version: int
    big_endian: bool
    dim: tuple[int, ...]
    data_type: int
    pixdim: tuple[float, ...]
    vox_offset: float
    units: int
    qform_code: int
    sform_code: int
    quaternion: tuple[float, ...]
    """b, c, d, then the x, y, z offsets."""
    sform: tuple[float, ...]
    """Twelve numbers, three rows."""


def raw_fields(head: bytes, pointer: str) -> RawFields:
    """Fields of the header at the start of `head`, which holds 540 bytes or the whole file.

    Raises:
        InputError: `UNREADABLE_LABEL_MAP` when it is no NIfTI; `UNSUPPORTED_LABEL_MAP` when it is
            Analyze 7.5 or the header half of a two-file NIfTI.
    """
    version, order = _recognise(head, pointer)

    def take(layout: str, offset: int) -> tuple[Any, ...]:
        return struct.unpack_from(order + layout, head, offset)

    if version == 1:
        return RawFields(
            version=1,
            big_endian=order == ">",
            dim=take("8h", 40),
            data_type=take("h", 70)[0],
            pixdim=take("8f", 76),
            vox_offset=take("f", 108)[0],
            units=take("B", 123)[0],
            qform_code=take("h", 252)[0],
            sform_code=take("h", 254)[0],
            quaternion=take("6f", 256),
            sform=take("12f", 280),
        )
    return RawFields(
        version=2,
        big_endian=order == ">",
        dim=take("8q", 16),
        data_type=take("h", 12)[0],
        pixdim=take("8d", 104),
        vox_offset=take("q", 168)[0],
        units=take("i", 500)[0],
        qform_code=take("i", 344)[0],
        sform_code=take("i", 348)[0],
        quaternion=take("6d", 352),
        sform=take("12d", 400),
    )


def _recognise(head: bytes, pointer: str) -> tuple[int, str]:
    """Version and byte order, from the header's own length and the magic."""
    for version, size in HEADER_BYTES.items():
        for order in "<>":
            if head[:4] != struct.pack(order + "i", size):
                continue
            if len(head) < size:
                raise unreadable(pointer, f"it ends inside its {size}-byte header", _REMEDY)
            single, pair = _MAGICS[version]
            at = _MAGIC_AT[version]
            magic = head[at : at + len(single)]
            if magic == single:
                return version, order
            if version == 2 and magic != pair:
                break
            what = "the header of a two-file NIfTI" if magic == pair else "Analyze 7.5"
            raise InputError(
                ProblemType.UNSUPPORTED_LABEL_MAP,
                f"`{pointer}` is {what} (.hdr/.img), and its voxels are elsewhere. Remedy: save a "
                "single file, with `nibabel.save(nibabel.load('name.img'), 'labels.nii.gz')`.",
                pointer=pointer,
            )
    raise unreadable(pointer, _what_it_is(head), _REMEDY)


def _what_it_is(head: bytes) -> str:
    for at, magic, name in _OTHER_FORMATS:
        if head[at : at + len(magic)] == magic:
            return f"it is {name}"
    return "it is empty" if not head else "it does not begin with a NIfTI header"
