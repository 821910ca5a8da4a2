"""NIfTI files as bytes, written field by field, so that any field can be wrong.

Independent of nibabel and of `intake`: offsets are those of nifti1.h and nifti2.h.
"""

import gzip
import struct
from collections.abc import Sequence

import numpy as np

CODES = {
    "uint8": 2,
    "int16": 4,
    "int32": 8,
    "float32": 16,
    "float64": 64,
    "int8": 256,
    "uint16": 512,
    "uint32": 768,
    "int64": 1024,
    "uint64": 1280,
}


def nifti(
    voxels: np.ndarray,
    affine: np.ndarray | None,
    *,
    version: int = 1,
    order: str = "<",
    pixdim: Sequence[float] | None = None,
    units: int = 2,
    time_step: float = 0.0,
    quaternion: Sequence[float] | None = None,
    qfac: float = 1.0,
    dim: Sequence[int] | None = None,
    data_type: int | None = None,
    vox_offset: float | None = None,
    magic: bytes | None = None,
) -> bytes:
    """An uncompressed single file; `affine` (4 x 4) is the sform, none leaves its code 0.

    pixdim: the three sizes; left out, the affine's. quaternion: b, c, d, x, y, z of a qform.
    dim: the header's eight numbers, data_type its code, vox_offset and magic: to lie with.
    """
    size, start = {1: (348, 352), 2: (540, 544)}[version]
    head = bytearray(start)

    def put(layout: str, offset: int, *values: float) -> None:
        struct.pack_into(order + layout, head, offset, *values)

    sizes = [n for n in voxels.shape]
    dims = list(dim) if dim is not None else [len(sizes), *sizes, *[1] * (7 - len(sizes))]
    if pixdim is None:
        pixdim = np.linalg.norm(affine[:3, :3], axis=0) if affine is not None else (1.0, 1.0, 1.0)
    steps = [qfac, *pixdim, time_step, 0.0, 0.0, 0.0]
    code = CODES[voxels.dtype.name] if data_type is None else data_type
    offset = start if vox_offset is None else vox_offset
    codes = (int(quaternion is not None), int(affine is not None))
    q = [float(v) for v in quaternion or [0.0] * 6]
    rows = (affine[:3] if affine is not None else np.zeros((3, 4))).ravel().tolist()
    put("i", 0, size)
    if version == 1:
        put("8h", 40, *dims)
        put("2h", 70, code, voxels.dtype.itemsize * 8)
        put("8f", 76, *steps)
        put("f", 108, offset)
        put("B", 123, units)
        put("2h", 252, *codes)
        put("6f", 256, *q)
        put("12f", 280, *rows)
        head[344:348] = magic or b"n+1\0"
    else:
        head[4:12] = magic or b"n+2\0\r\n\x1a\n"
        put("2h", 12, code, voxels.dtype.itemsize * 8)
        put("8q", 16, *dims)
        put("8d", 104, *steps)
        put("q", 168, int(offset))
        put("2i", 344, *codes)
        put("6d", 352, *q)
        put("12d", 400, *rows)
        put("i", 500, units)
    body = voxels.astype(voxels.dtype.newbyteorder(order)).tobytes(order="F")
    return bytes(head) + body


def gz(data: bytes) -> bytes:
    return gzip.compress(data, 6, mtime=0)
